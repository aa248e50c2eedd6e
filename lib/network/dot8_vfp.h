/* dot8.h in the words of a Cortex-M with an FPU: eight weights a load.  vmla rounds the product before it
 * adds, as C does: the same bits.
 *
 *   r0 y     r2 w                             s0 to s7    the sums
 *   r1 x     r3 xi, as an integer             s8          xi
 *            r12 end of x                     s16 to s23  weights
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_DOT8_VFP_H
#define EDML_DOT8_VFP_H

#include "weights.h"

/* clang-format off */
#define ADD_INPUT                       \
    "    ldr    r3, [r1], #4\n"         \
    "    cbz    r3, 9f\n"               \
    "    vmov   s8, r3\n"               \
    "    vldmia r2, {s16-s23}\n"        \
    "    vmla.f32 s0, s16, s8\n"        \
    "    vmla.f32 s1, s17, s8\n"        \
    "    vmla.f32 s2, s18, s8\n"        \
    "    vmla.f32 s3, s19, s8\n"        \
    "    vmla.f32 s4, s20, s8\n"        \
    "    vmla.f32 s5, s21, s8\n"        \
    "    vmla.f32 s6, s22, s8\n"        \
    "    vmla.f32 s7, s23, s8\n"        \
    "9:  adds   r2, #32\n"

__attribute__((naked, noinline)) static void dot8(
    value y[EDML_ROWS] EDML_IN_REGISTER, const value *x EDML_IN_REGISTER,
    const weight *w EDML_IN_REGISTER, const value *b EDML_IN_REGISTER, int inputs EDML_IN_REGISTER)
{
    __asm__("    ldr    r12, [sp]\n"
            "    vpush  {s16-s23}\n"
            "    vldmia r3, {s0-s7}\n"
            "    add    r12, r1, r12, lsl #2\n"
            "1:  sub    r3, r12, r1\n" /* up to four at a time */
            "    cmp    r3, #16\n"
            "    blo    3f\n"
            ADD_INPUT ADD_INPUT ADD_INPUT ADD_INPUT
            "    b      1b\n"
            "2:\n"
            ADD_INPUT
            "3:  cmp    r1, r12\n"
            "    bne    2b\n"
            "    vstmia r0, {s0-s7}\n"
            "    vpop   {s16-s23}\n"
            "    bx     lr\n");
}
/* clang-format on */

#endif
