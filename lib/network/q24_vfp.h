/* q24_by_value.h in the words of a Cortex-M with an FPU, which converts fixed point: four values at a time.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_Q24_VFP_H
#define EDML_Q24_VFP_H

#include <stdint.h>

#include "../number/compiler.h"

/* clang-format off */
#define CONVERT_FOUR(convert)                                               \
    __asm__("1:  vldmia  r1!, {s0-s3}\n"                                    \
            "    " convert " s0, s0, #24\n"                                 \
            "    " convert " s1, s1, #24\n"                                 \
            "    " convert " s2, s2, #24\n"                                 \
            "    " convert " s3, s3, #24\n"                                 \
            "    vstmia  r0!, {s0-s3}\n"                                    \
            "    subs    r2, #4\n"                                          \
            "    bgt     1b\n"                                              \
            "    bx      lr\n")
/* clang-format on */

__attribute__((naked, noinline)) static void
to_q24(int32_t *out EDML_IN_REGISTER, const float *in EDML_IN_REGISTER, int count EDML_IN_REGISTER)
{
    CONVERT_FOUR("vcvt.s32.f32");
}

__attribute__((naked, noinline)) static void
from_q24(float *out EDML_IN_REGISTER, const int32_t *in EDML_IN_REGISTER, int count EDML_IN_REGISTER)
{
    CONVERT_FOUR("vcvt.f32.s32");
}

#endif
