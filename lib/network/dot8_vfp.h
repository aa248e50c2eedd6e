/* dot8.h in the words of a Cortex-M with an FPU: four weights a load.  vmla rounds the product before
 * it adds, as C does: the same bits.
 *
 *   r0 y     r2 w                r12     the end of x       s8 to s11  weights
 *   r1 x     r3 xi, as an integer        s0 to s7  the sums     s15  xi
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_DOT8_VFP_H
#define EDML_DOT8_VFP_H

#include "weights.h"

__attribute__((naked, noinline)) static void
dot8(value y[EDML_ROWS] EDML_IN_REGISTER, const value *x EDML_IN_REGISTER, const weight *w EDML_IN_REGISTER,
     const value *b EDML_IN_REGISTER, int inputs EDML_IN_REGISTER)
{
    __asm__("    ldr    r12, [sp]\n"
            "    add    r12, r1, r12, lsl #2\n"
            "    vldmia r3, {s0-s7}\n"
            "1:  ldr    r3, [r1], #4\n"
            "    vmov   s15, r3\n"
            "    lsls   r3, r3, #1\n" /* zero, of either sign */
            "    beq    3f\n"
            "    vldmia r2!, {s8-s11}\n"
            "    vmla.f32 s0, s8, s15\n"
            "    vmla.f32 s1, s9, s15\n"
            "    vmla.f32 s2, s10, s15\n"
            "    vmla.f32 s3, s11, s15\n"
            "    vldmia r2!, {s8-s11}\n"
            "    vmla.f32 s4, s8, s15\n"
            "    vmla.f32 s5, s9, s15\n"
            "    vmla.f32 s6, s10, s15\n"
            "    vmla.f32 s7, s11, s15\n"
            "    cmp    r1, r12\n"
            "    bne    1b\n"
            "2:  vstmia r0, {s0-s7}\n"
            "    bx     lr\n"
            "3:  adds   r2, #32\n" /* a zero, as most are */
            "    cmp    r1, r12\n"
            "    bne    1b\n"
            "    b      2b\n");
}

#endif
