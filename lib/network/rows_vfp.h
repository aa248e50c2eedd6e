/* rows.h in the words of a Cortex-M with an FPU: sixteen rows of weights that lie input by input, in groups of eight.
 * Whether an input is zero is asked once for all of them.
 *
 *   r0 y     r2, r4 weights of both groups    s0 to s15   the sums
 *   r1 x     r3, r5 two of x, as integers     s24, s25    the same
 *            r12 end of x                     s16 to s23  weights
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_ROWS_VFP_H
#define EDML_ROWS_VFP_H

#include "rows_all_inputs.h"

#include "dot8_vfp.h"

enum { ROWS = 2 * EDML_ROWS };

/* clang-format off */
#define ADD_TO_SIXTEEN_SUMS(xi)                                                                         \
    ADD_TO_GROUP(xi, "r2", "s0", "s1", "s2", "s3", "s4", "s5", "s6", "s7")                              \
    ADD_TO_GROUP(xi, "r4", "s8", "s9", "s10", "s11", "s12", "s13", "s14", "s15")
#define SKIP_SIXTEEN                    \
    "    adds   r2, #32\n"              \
    "    adds   r4, #32\n"

/* As dot8(), of the groups at w and `stride` bytes behind it. */
__attribute__((naked, noinline)) static void dot16(
    value y[ROWS] EDML_IN_REGISTER, const value *x EDML_IN_REGISTER,
    const weight *w EDML_IN_REGISTER, const value *b EDML_IN_REGISTER, int inputs EDML_IN_REGISTER,
    int stride EDML_IN_REGISTER)
{
    __asm__("    push   {r4, r5}\n"
            "    ldrd   r12, r4, [sp, #8]\n"
            "    vpush  {s16-s25}\n"
            "    vldmia r3, {s0-s15}\n"
            "    adds   r4, r4, r2\n"
            ADD_INPUTS(ADD_TO_SIXTEEN_SUMS, SKIP_SIXTEEN)
            "    vstmia r0, {s0-s15}\n"
            "    vpop   {s16-s25}\n"
            "    pop    {r4, r5}\n"
            "    bx     lr\n");
}
/* clang-format on */

static void sum_rows(value sum[2][ROWS], const layer_inputs *in, const weight *w, const value *bias,
                     int rows)
{
    static const value none[ROWS] = {0};
    const weight *const of_odd = w + EDML_ROWS * in->even;
    if (rows == ROWS) {
        const int stride = (int)sizeof *w * EDML_ROWS * in->inputs;
        dot16(sum[0], in->x, w, bias, in->even, stride);
        if (in->odd > 0) dot16(sum[1], in->x + in->even, of_odd, none, in->odd, stride);
    } else {
        dot8(sum[0], in->x, w, bias, in->even);
        if (in->odd > 0) dot8(sum[1], in->x + in->even, of_odd, none, in->odd);
    }
}

#endif
