/* units_by_row.h in the words of a Cortex-M with Helium (MVE): four rows at a time.
 *
 *   r0, r1 where sums and differences of units go     r2 sum, r3 multipliers
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_UNITS_MVE_H
#define EDML_UNITS_MVE_H

#include "weights_integer.h"

#include "rows.h"

typedef char paired_units_have_14_bits[EDML_PAIRED_BITS == 14 ? 1 : -1];

/* clang-format off */
#define ACTIVATE_FOUR                                                   \
    "    vldrw.u32  q1, [r2, #32]\n" /* sum[1] */                       \
    "    vldrw.u32  q0, [r2], #16\n"                                    \
    "    vldrw.u32  q2, [r3], #16\n"                                    \
    "    vadd.i32   q3, q0, q1\n"                                       \
    "    vsub.i32   q0, q0, q1\n"                                       \
    "    vrmulh.s32 q3, q3, q2\n"                                       \
    "    vrmulh.s32 q0, q0, q2\n"                                       \
    "    vqshlu.s32 q3, q3, #18\n" /* to 14 bits of 32, and back */     \
    "    vqshlu.s32 q0, q0, #18\n"                                      \
    "    vshr.u32   q3, q3, #18\n"                                      \
    "    vshr.u32   q0, q0, #18\n"                                      \
    "    vadd.i32   q1, q3, q0\n"                                       \
    "    vsub.i32   q3, q3, q0\n"                                       \
    "    vstrh.32   q1, [r0], #8\n"                                     \
    "    vstrh.32   q3, [r1], #8\n"

__attribute__((naked, noinline)) static void activate_eight(
    activation *sums EDML_IN_REGISTER, activation *differences EDML_IN_REGISTER,
    value sum[2][ROWS] EDML_IN_REGISTER, const int32_t *multiplier EDML_IN_REGISTER)
{
    __asm__(ACTIVATE_FOUR ACTIVATE_FOUR
            "    bx     lr\n");
}
/* clang-format on */

static inline void activate_rows(activation *y, value sum[2][ROWS], const dense_layer *layer, int row,
                                 int rows, int count)
{
    (void)rows;
    activate_eight(y, y + count, sum, layer->multiplier + row);
}

#endif
