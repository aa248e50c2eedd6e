/* ends_by_value.h for integers, in the words of a Cortex-M with the DSP extension: four inputs, or two rows, at a time.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_ENDS_DSP_H
#define EDML_ENDS_DSP_H

#include "weights_integer.h"

#include "rows.h"

typedef char inputs_are_q12_and_outputs_q16[EDML_INPUT_SHIFT == 12 && EDML_OUTPUT_SHIFT == 8 ? 1 : -1];

/* clang-format off */
/* As signed_input(). */
#define READ_INPUT(x)                           \
    "    asr    " x ", " x ", #11\n"            \
    "    adds   " x ", #1\n"                    \
    "    ssat   " x ", #16, " x ", asr #1\n"

/*   r0 x     r1 in     r2 end of in     r3 to r6 inputs */
__attribute__((naked, noinline)) static void read_fours(
    activation *x EDML_IN_REGISTER, const value *in EDML_IN_REGISTER, const value *end EDML_IN_REGISTER)
{
    __asm__("    push   {r4-r6, lr}\n"
            "    b      2f\n"
            "1:  ldmia  r1!, {r3-r6}\n"
            READ_INPUT("r3") READ_INPUT("r4") READ_INPUT("r5") READ_INPUT("r6")
            "    pkhbt  r3, r3, r4, lsl #16\n"
            "    pkhbt  r4, r5, r6, lsl #16\n"
            "    strd   r3, r4, [r0], #8\n"
            "2:  cmp    r1, r2\n"
            "    bne    1b\n"
            "    pop    {r4-r6, pc}\n");
}

/* As signed_output().  Adding r5 saturates what is above clamp.  Less r6 it is the output + clamp, and what is below -clamp
 * saturates at zero.  0 <= clamp < 2^22. */
#define GIVE_OUTPUT(output, multiplier)                         \
    "    lsl    " output ", r4\n"                               \
    "    smmulr " output ", " output ", " multiplier "\n"       \
    "    qadd   " output ", " output ", r5\n"                   \
    "    sub    " output ", r6\n"                               \
    "    usat   " output ", #31, " output "\n"                  \
    "    rsb    " output ", r7, " output ", lsl #8\n"

/* A row and its mirror row. */
#define GIVE_ROW(even, odd, multiplier)                         \
    "    add    " even ", " odd "\n"                            \
    "    sub    " odd ", " even ", " odd ", lsl #1\n"           \
    GIVE_OUTPUT(even, multiplier) GIVE_OUTPUT(odd, multiplier)

/*   r0 out            r2 even parts     r4 left shift         r7 clamp * 2^8             r10, r11 odd parts, then mirror rows
 *   r1 mirror rows    r3 multipliers    r5 2^31 - 1 - clamp   r8, r9 even parts,         r12, lr two multipliers
 *                                       r6 r5 - clamp         then rows */
__attribute__((naked, noinline)) static void give_eight(
    value *out EDML_IN_REGISTER, value *mirror EDML_IN_REGISTER, value sum[2][ROWS] EDML_IN_REGISTER,
    const int32_t *multiplier EDML_IN_REGISTER, int left_shift EDML_IN_REGISTER, int32_t clamp EDML_IN_REGISTER)
{
    __asm__("    push   {r4-r11, lr}\n"
            "    ldrd   r4, r6, [sp, #36]\n"
            "    add    r7, r2, #32\n"
            "    push   {r7}\n" /* [sp] end of the even parts */
            "    lsl    r7, r6, #8\n"
            "    mvn    r5, r6\n"
            "    eor    r5, #0x80000000\n"
            "    sub    r6, r5, r6\n"
            "1:  ldrd   r10, r11, [r2, #32]\n"
            "    ldrd   r8, r9, [r2], #8\n"
            "    ldrd   r12, lr, [r3], #8\n"
            GIVE_ROW("r8", "r10", "r12") GIVE_ROW("r9", "r11", "lr")
            "    strd   r8, r9, [r0], #8\n"
            "    strd   r10, r11, [r1], #8\n"
            "    ldr    r8, [sp]\n"
            "    cmp    r2, r8\n"
            "    bne    1b\n"
            "    pop    {r3-r11, pc}\n");
}
/* clang-format on */

static int read_inputs(activation *x, const value *in, int inputs)
{
    const int fours = inputs / 4 * 4, filled = (inputs + CHUNK - 1) / CHUNK * CHUNK;
    read_fours(x, in, in + fours);
    for (int k = fours; k < filled; k++) x[k] = k < inputs ? (activation)signed_input(in[k]) : 0;
    return filled;
}

static inline void give_rows(value *out, value sum[2][ROWS], const dense_layer *last, int row, int rows,
                             int count)
{
    (void)rows;
    give_eight(out, out + count, sum, last->multiplier + row, 32 - last->shift, last->clamp);
}

#endif
