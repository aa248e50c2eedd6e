/* rows_by_row.h in the words of a Cortex-M with Helium (MVE): eight products at a time, weights of 8 bits widened
 * by the load.
 *
 *   r1 x, r3 w                              r0, r2, r4, r6, r8, r10, r12, lr  the sums
 *   r5 end of the part, r7 of all           q0 x, q1 and q2 weights
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_ROWS_MVE_H
#define EDML_ROWS_MVE_H

#include "rows_all_inputs.h"

enum { ROWS = EDML_ROWS };

#ifdef EDML_BYTES
#define ADD_ROW(sum, q) "vldrb.s16 " q ", [r3], #8\n vmladava.s16 " sum ", q0, " q "\n"
#else
#define ADD_ROW(sum, q) "vldrh.u16 " q ", [r3], #16\n vmladava.s16 " sum ", q0, " q "\n"
#endif
#define THE_SUMS "{r0, r2, r4, r6, r8, r10, r12, lr}\n"

/* clang-format off */
__attribute__((naked, noinline)) static void sum_rows(
    value sum[2][ROWS] EDML_IN_REGISTER, const layer_inputs *in EDML_IN_REGISTER,
    const weight *w EDML_IN_REGISTER, const value *bias EDML_IN_REGISTER, int rows EDML_IN_REGISTER)
{
    __asm__("    push   {r0, r4-r10, lr}\n" /* [sp] where sums go */
            "    ldmia  r1, {r1, r5, r7}\n"
            "    add    r5, r1, r5, lsl #1\n"
            "    add    r7, r5, r7, lsl #1\n"
            "    mov    r9, r3\n"
            "    mov    r3, r2\n"
            "    ldmia  r9, " THE_SUMS
            "1:  vldrh.u16 q0, [r1], #16\n"
            ADD_ROW("r0", "q1") ADD_ROW("r2", "q2") ADD_ROW("r4", "q1") ADD_ROW("r6", "q2")
            ADD_ROW("r8", "q1") ADD_ROW("r10", "q2") ADD_ROW("r12", "q1") ADD_ROW("lr", "q2")
            "    cmp    r1, r5\n"
            "    bne    1b\n"
            "    ldr    r9, [sp]\n"
            "    stmia  r9!, " THE_SUMS
            "    str    r9, [sp]\n"
            "    clrm   " THE_SUMS
            "    mov    r5, r7\n"
            "    cmp    r1, r7\n"
            "    bne    1b\n"
            "    add    sp, #4\n"
            "    pop    {r4-r10, pc}\n");
}
/* clang-format on */

#endif
