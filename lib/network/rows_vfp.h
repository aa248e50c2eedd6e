/* rows.h in the words of a Cortex-M with an FPU: sixteen rows of weights that lie input by input, in groups of eight.
 * Whether an input is zero is asked once for all of them.  vmla rounds the product before it adds, as C does: the same bits.
 *
 *   r0 y     r2, r4 weights of both groups    s0 to s15   the sums
 *   r1 x     r3 xi, as an integer             s24         xi
 *            r12 end of x                     s16 to s23  weights
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_ROWS_VFP_H
#define EDML_ROWS_VFP_H

#include "rows_all_inputs.h"

#include "dot8.h"

enum { ROWS = 2 * EDML_ROWS };

/* clang-format off */
#define ADD_TO_GROUP(w, s0, s1, s2, s3, s4, s5, s6, s7) \
    "    vldmia " w "!, {s16-s23}\n"    \
    "    vmla.f32 " s0 ", s16, s24\n"   \
    "    vmla.f32 " s1 ", s17, s24\n"   \
    "    vmla.f32 " s2 ", s18, s24\n"   \
    "    vmla.f32 " s3 ", s19, s24\n"   \
    "    vmla.f32 " s4 ", s20, s24\n"   \
    "    vmla.f32 " s5 ", s21, s24\n"   \
    "    vmla.f32 " s6 ", s22, s24\n"   \
    "    vmla.f32 " s7 ", s23, s24\n"

/* As dot8(), of the groups at w and `stride` bytes behind it; inputs > 0. */
__attribute__((naked, noinline)) static void dot16(
    value y[ROWS] EDML_IN_REGISTER, const value *x EDML_IN_REGISTER,
    const weight *w EDML_IN_REGISTER, const value *b EDML_IN_REGISTER, int inputs EDML_IN_REGISTER,
    int stride EDML_IN_REGISTER)
{
    __asm__("    push   {r4, lr}\n"
            "    ldrd   r12, r4, [sp, #8]\n"
            "    vpush  {s16-s25}\n"
            "    vldmia r3, {s0-s15}\n"
            "    adds   r4, r4, r2\n"
            "    add    r12, r1, r12, lsl #2\n"
            "1:  ldr    r3, [r1], #4\n"
            "    cbnz   r3, 2f\n"
            "    adds   r2, #32\n"
            "    adds   r4, #32\n"
            "    cmp    r1, r12\n"
            "    bne    1b\n"
            "    b      3f\n"
            "2:  vmov   s24, r3\n"
            ADD_TO_GROUP("r2", "s0", "s1", "s2", "s3", "s4", "s5", "s6", "s7")
            ADD_TO_GROUP("r4", "s8", "s9", "s10", "s11", "s12", "s13", "s14", "s15")
            "    cmp    r1, r12\n"
            "    bne    1b\n"
            "3:  vstmia r0, {s0-s15}\n"
            "    vpop   {s16-s25}\n"
            "    pop    {r4, pc}\n");
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
