/* rows_by_row.h, four rows, in the words of a Cortex-M with Helium (MVE): eight products at a time, weights of
 * 8 bits widened by the load.
 *
 *   r1 x, r2 w, r3 bias, then how many inputs      r4, r6, r8, r10  the sums
 *   r5 end of the part, r7 of all                  q0 x, q1 and q2 weights
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_ROWS_MVE_H
#define EDML_ROWS_MVE_H

#include "rows_of_four.h"

#define SLOT(k) (k)

#ifdef EDML_BYTES
#define ADD_ROW(sum, q) "vldrb.s16 " q ", [r2], #8\n vmladava.s16 " sum ", q0, " q "\n"
#else
#define ADD_ROW(sum, q) "vldrh.u16 " q ", [r2], #16\n vmladava.s16 " sum ", q0, " q "\n"
#endif

/* clang-format off */
__attribute__((naked, noinline)) static void sum_rows(
    value sum[2][ROWS] EDML_IN_REGISTER, const layer_inputs *in EDML_IN_REGISTER,
    const weight *w EDML_IN_REGISTER, const value *bias EDML_IN_REGISTER, int rows EDML_IN_REGISTER)
{
    __asm__("    push   {r4-r10, lr}\n"
            "    ldmia  r1, {r1, r5, r7}\n"
            "    add    r5, r1, r5, lsl #1\n"
            "    add    r7, r5, r7, lsl #1\n"
            "    ldrd   r4, r6, [r3]\n"
            "    ldrd   r8, r10, [r3, #8]\n"
            "1:  subs   r3, r5, r1\n"
            "    lsrs   r3, r3, #4\n"
            "    dls    lr, r3\n"
            "2:  vldrh.u16 q0, [r1], #16\n"
            ADD_ROW("r4", "q1") ADD_ROW("r6", "q2") ADD_ROW("r8", "q1") ADD_ROW("r10", "q2")
            "    adds   r2, #" OTHER_HALF "\n" /* the block's other rows */
            "    le     lr, 2b\n"
            "    strd   r4, r6, [r0], #8\n"
            "    strd   r8, r10, [r0], #8\n"
            "    movs   r4, #0\n"
            "    movs   r6, #0\n"
            "    mov    r8, #0\n"
            "    mov    r10, #0\n"
            "    mov    r5, r7\n"
            "    cmp    r1, r7\n"
            "    bne    1b\n"
            "    pop    {r4-r10, pc}\n");
}
/* clang-format on */

#endif
