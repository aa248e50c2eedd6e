/* dot8.h for bytes in blocks by pair, in the words of a Cortex-M with the DSP extension.  As rows_dsp.h has it, but
 * pairs are not listed: each window is read only a few times.
 *
 *   r0 a pair of x     r1 x, r2 w     r3, r12 weights, lr widened ones     r3 also the end of x     r4 to r11 the sums
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_DOT8_DSP_H
#define EDML_DOT8_DSP_H

#include "weights_w8.h"

#include "rows_dsp.h"

/* clang-format off */
#define ADD_BYTES(pair)                         \
    "    ldr    r0, [r1], #4\n"                 \
    "    cbz    r0, 9f\n"                       \
    "    ldrd   r3, r12, [r2, #" pair "*16]\n"  \
    ADD_TWO_ROWS("r3", "r4", "r5") ADD_TWO_ROWS("r12", "r6", "r7")              \
    "    ldrd   r3, r12, [r2, #" pair "*16+8]\n"                                \
    ADD_TWO_ROWS("r3", "r8", "r9") ADD_TWO_ROWS("r12", "r10", "r11")            \
    "9:\n"

/* inputs: a multiple of CHUNK, > 0. */
__attribute__((naked, noinline)) static void dot8(
    value y[EDML_ROWS] EDML_IN_REGISTER, const activation *x EDML_IN_REGISTER,
    const weight *w EDML_IN_REGISTER, const value *b EDML_IN_REGISTER, int inputs EDML_IN_REGISTER)
{
    __asm__("    push   {r0, r4-r11, lr}\n"
            "    ldr    lr, [sp, #40]\n" /* inputs */
            "    ldmia  r3, {r4-r11}\n"
            "    add    r3, r1, lr, lsl #1\n"
            "    push   {r3}\n" /* [sp] end of x, [sp, #4] y */
            "1:\n"
            ADD_BYTES("0") ADD_BYTES("1") ADD_BYTES("2") ADD_BYTES("3") /* a block */
            "    ldr    r3, [sp]\n"
            "    adds   r2, #64\n"
            "    cmp    r1, r3\n"
            "    bne    1b\n"
            "    pop    {r3, r12}\n"
            "    stmia  r12, {r4-r11}\n"
            "    pop    {r4-r11, pc}\n");
}
/* clang-format on */

#endif
