/* ends_by_value.h for floats, in the words of a Cortex-M with an FPU: four rows at a time.  Inputs are read as they are:
 * those that lie where units are to be read stay there.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_ENDS_VFP_H
#define EDML_ENDS_VFP_H

#include <string.h>

#include "units_vfp.h"

static int read_inputs(activation *x, const value *in, int inputs)
{
    if (x != in) memcpy(x, in, (size_t)inputs * sizeof *x);
    return inputs;
}

/* clang-format off */
/* Registers as in units_vfp.h; rows: a multiple of 4, > 0. */
__attribute__((naked, noinline)) static void give_fours(
    value *out EDML_IN_REGISTER, value *of_mirror_rows EDML_IN_REGISTER,
    value sum[2][ROWS] EDML_IN_REGISTER, int rows EDML_IN_REGISTER)
{
    __asm__("    add    r12, r2, #64\n"
            "1:\n"
            TAKE_SUMS
            "    vstmia r0!, {s8-s11}\n"
            "    vstmia r1!, {s12-s15}\n"
            "    subs   r3, #4\n"
            "    bne    1b\n"
            "    bx     lr\n");
}
/* clang-format on */

static inline void give_rows(value *out, value sum[2][ROWS], const dense_layer *last, int row, int rows,
                             int count)
{
    (void)last, (void)row;
    give_fours(out, out + count, sum, rows);
}

#endif
