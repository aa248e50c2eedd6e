/* rows_by_row.h, four rows, in the words of a Cortex-M with the DSP extension, which multiplies two pairs of 16
 * bits at a time.  Weights of 8 bits are widened two at a time: the first and the third of a word, then the second and
 * the fourth, and in that order the units are kept.
 *
 *   r0, r3, r12, lr  weights     r4 to r7   the sums
 *   r1 x, r2 w                   r8 to r11  eight x
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_ROWS_DSP_H
#define EDML_ROWS_DSP_H

#include "rows_all_inputs.h"

enum { ROWS = EDML_ROWS / 2 }; /* the upper or the lower half of a block */
#define WEIGHTS_OF(layer, row)                                                                             \
    ((layer)->weight + ((row) & -EDML_ROWS) * (layer)->inputs + ((row) & (EDML_ROWS - 1)) * EDML_CHUNK)

/* clang-format off */
#ifdef EDML_BYTES
#define SLOT(k) (((k) & ~3) | ((k) & 1) << 1 | ((k) >> 1 & 1))
#define OTHER_HALF "32" /* bytes */
#define ADD_ROW(sum)                               \
    "    ldmia  r2!, {r0, r3}\n"                   \
    "    sxtb16 r12, r0\n"                         \
    "    smlad  " sum ", r12, r8, " sum "\n"       \
    "    sxtb16 r0, r0, ror #8\n"                  \
    "    smlad  " sum ", r0, r9, " sum "\n"        \
    "    sxtb16 r12, r3\n"                         \
    "    smlad  " sum ", r12, r10, " sum "\n"      \
    "    sxtb16 r3, r3, ror #8\n"                  \
    "    smlad  " sum ", r3, r11, " sum "\n"
#else
#define SLOT(k) (k)
#define OTHER_HALF "64"
#define ADD_ROW(sum)                               \
    "    ldmia  r2!, {r0, r3, r12, lr}\n"          \
    "    smlad  " sum ", r0, r8, " sum "\n"        \
    "    smlad  " sum ", r3, r9, " sum "\n"        \
    "    smlad  " sum ", r12, r10, " sum "\n"      \
    "    smlad  " sum ", lr, r11, " sum "\n"
#endif

#define ADD_BLOCK                                  \
    "    ldmia  r1!, {r8-r11}\n"                   \
    ADD_ROW("r4") ADD_ROW("r5") ADD_ROW("r6") ADD_ROW("r7") \
    "    adds   r2, #" OTHER_HALF "\n" /* past the block's other rows */

__attribute__((naked, noinline)) static void sum_rows(
    value sum[2][ROWS] EDML_IN_REGISTER, const layer_inputs *in EDML_IN_REGISTER,
    const weight *w EDML_IN_REGISTER, const value *bias EDML_IN_REGISTER, int rows EDML_IN_REGISTER)
{
    __asm__("    push   {r0, r4-r11, lr}\n"
            "    ldmia  r1, {r1, r8, r9}\n"
            "    ldmia  r3, {r4-r7}\n"
            "    add    r8, r1, r8, lsl #1\n"
            "    add    r9, r8, r9, lsl #1\n"
            "    push   {r8, r9}\n" /* [sp] end of the part, [sp, #4] of all, [sp, #8] where sums go */
            "1:  subs   r0, r8, r1\n"
            "    lsls   r0, r0, #27\n"
            "    bpl    2f\n" /* an even number of blocks, two at a time; else one before */
            ADD_BLOCK
            "    ldr    r0, [sp]\n"
            "    cmp    r1, r0\n"
            "    beq    3f\n"
            "2:\n"
            ADD_BLOCK ADD_BLOCK
            "    ldr    r0, [sp]\n"
            "    cmp    r1, r0\n"
            "    bne    2b\n"
            "3:\n"
            "    ldrd   r8, r12, [sp, #4]\n"
            "    stmia  r12!, {r4-r7}\n"
            "    str    r8, [sp]\n"
            "    str    r12, [sp, #8]\n"
            "    movs   r4, #0\n"
            "    movs   r5, #0\n"
            "    movs   r6, #0\n"
            "    movs   r7, #0\n"
            "    cmp    r1, r8\n"
            "    bne    1b\n"
            "    add    sp, #12\n"
            "    pop    {r4-r11, pc}\n");
}
/* clang-format on */

#endif
