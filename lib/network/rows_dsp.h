/* rows.h for blocks by pair, in the words of a Cortex-M with the DSP extension, which multiplies two pairs of 16
 * bits at a time: eight rows.  Pairs of inputs that are both zero are left out.  Weights of 8 bits are widened two at
 * a time: the first and the third byte of a word are of one row, the second and the fourth of the next.
 *
 *   r0 a pair of x     r1 x, r2 w     r3, r12 weights     r4 to r11 the sums
 *   lr                 16 bits: end of the part; 8 bits: widened weights
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_ROWS_DSP_H
#define EDML_ROWS_DSP_H

#include "rows_all_inputs.h"

enum { ROWS = EDML_ROWS };

/* clang-format off */
#ifdef EDML_BYTES
#define ADD_TWO_ROWS(w, sum, next)              \
    "    sxtb16 lr, " w "\n"                    \
    "    smlad  " sum ", lr, r0, " sum "\n"     \
    "    sxtb16 " w ", " w ", ror #8\n"         \
    "    smlad  " next ", " w ", r0, " next "\n"
#define ADD_ROWS(pair)                                                          \
    "    ldrd   r3, r12, [r2, #" pair "*16]\n"                                  \
    ADD_TWO_ROWS("r3", "r4", "r5") ADD_TWO_ROWS("r12", "r6", "r7")              \
    "    ldrd   r3, r12, [r2, #" pair "*16+8]\n"                                \
    ADD_TWO_ROWS("r3", "r8", "r9") ADD_TWO_ROWS("r12", "r10", "r11")
#define IS_AT_END "ldr r3, [sp]\n cmp r1, r3\n"
#else
#define ADD_TWO_ROWS(place, sum, next)          \
    "    ldrd   r3, r12, [r2, #" place "]\n"    \
    "    smlad  " sum ", r3, r0, " sum "\n"     \
    "    smlad  " next ", r12, r0, " next "\n"
#define ADD_ROWS(pair)                                                              \
    ADD_TWO_ROWS(pair "*32", "r4", "r5") ADD_TWO_ROWS(pair "*32+8", "r6", "r7")     \
    ADD_TWO_ROWS(pair "*32+16", "r8", "r9") ADD_TWO_ROWS(pair "*32+24", "r10", "r11")
#define IS_AT_END "cmp r1, lr\n"
#endif

#define ADD_PAIR(pair)                          \
    "    ldr    r0, [r1], #4\n"                 \
    "    cbz    r0, 9f\n"                       \
    ADD_ROWS(pair)                              \
    "9:\n"

__attribute__((naked, noinline)) static void sum_rows(
    value sum[2][ROWS] EDML_IN_REGISTER, const layer_inputs *in EDML_IN_REGISTER,
    const weight *w EDML_IN_REGISTER, const value *bias EDML_IN_REGISTER, int rows EDML_IN_REGISTER)
{
    __asm__("    push   {r0, r4-r11, lr}\n"
            "    ldmia  r1, {r1, r8, r9}\n"
            "    add    r8, r1, r8, lsl #1\n"
            "    add    r9, r8, r9, lsl #1\n"
            "    push   {r8, r9}\n" /* [sp] end of the part, [sp, #4] of all, [sp, #8] where sums go */
            "    mov    lr, r8\n"
            "    ldmia  r3, {r4-r11}\n"
            "1:\n"
            ADD_PAIR("0") ADD_PAIR("1") ADD_PAIR("2") ADD_PAIR("3") /* a block */
#ifdef EDML_BYTES
            "    adds   r2, #64\n"
#else
            "    adds   r2, #128\n"
#endif
            IS_AT_END
            "    bne    1b\n"
            "    ldrd   lr, r3, [sp, #4]\n"
            "    stmia  r3!, {r4-r11}\n"
            "    str    lr, [sp]\n"
            "    str    r3, [sp, #8]\n"
            "    cmp    r1, lr\n"
            "    beq    2f\n"
            "    movs   r4, #0\n"
            "    movs   r5, #0\n"
            "    movs   r6, #0\n"
            "    movs   r7, #0\n"
            "    mov    r8, r4\n"
            "    mov    r9, r4\n"
            "    mov    r10, r4\n"
            "    mov    r11, r4\n"
            "    b      1b\n"
            "2:  add    sp, #12\n"
            "    pop    {r4-r11, pc}\n");
}
/* clang-format on */

#endif
