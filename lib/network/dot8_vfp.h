/* dot8.h in the words of a Cortex-M with an FPU: two inputs and eight weights a load.  vmla rounds the product
 * before it adds, as C does: the same bits.
 *
 *   r0 y     r2 w                           s0 to s7    the sums
 *   r1 x     r3, r5 two of x, as integers   s24, s25    the same
 *            r12 end of x                   s16 to s23  weights
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_DOT8_VFP_H
#define EDML_DOT8_VFP_H

#include "weights.h"

/* clang-format off */
#define ADD_TO_GROUP(xi, w, s0, s1, s2, s3, s4, s5, s6, s7)     \
    "    vldmia " w "!, {s16-s23}\n"            \
    "    vmla.f32 " s0 ", s16, " xi "\n"        \
    "    vmla.f32 " s1 ", s17, " xi "\n"        \
    "    vmla.f32 " s2 ", s18, " xi "\n"        \
    "    vmla.f32 " s3 ", s19, " xi "\n"        \
    "    vmla.f32 " s4 ", s20, " xi "\n"        \
    "    vmla.f32 " s5 ", s21, " xi "\n"        \
    "    vmla.f32 " s6 ", s22, " xi "\n"        \
    "    vmla.f32 " s7 ", s23, " xi "\n"

/* Reads as many inputs as r12 says: ADD(xi) adds the products of one, SKIP passes its weights by where it is zero. */
#define ADD_INPUTS(ADD, SKIP)                   \
    "    tst    r12, #1\n"                      \
    "    add    r12, r1, r12, lsl #2\n"         \
    "    beq    1f\n"                           \
    "    vldmia r1!, {s24}\n" /* an odd one */  \
    ADD("s24")                                  \
    "1:  cmp    r1, r12\n"                      \
    "    beq    6f\n"                           \
    "2:  ldrd   r3, r5, [r1], #8\n"             \
    "    vmov   s24, s25, r3, r5\n"             \
    "    cbnz   r3, 3f\n"                       \
    SKIP                                        \
    "    cbnz   r5, 4f\n"                       \
    "    b      5f\n"                           \
    "3:\n"                                      \
    ADD("s24")                                  \
    "    cbz    r5, 5f\n"                       \
    "4:\n"                                      \
    ADD("s25")                                  \
    "    cmp    r1, r12\n"                      \
    "    bne    2b\n"                           \
    "    b      6f\n"                           \
    "5:\n"                                      \
    SKIP                                        \
    "    cmp    r1, r12\n"                      \
    "    bne    2b\n"                           \
    "6:\n"

#define ADD_TO_EIGHT_SUMS(xi) ADD_TO_GROUP(xi, "r2", "s0", "s1", "s2", "s3", "s4", "s5", "s6", "s7")
#define SKIP_EIGHT "    adds   r2, #32\n"

__attribute__((naked, noinline)) static void dot8(
    value y[EDML_ROWS] EDML_IN_REGISTER, const value *x EDML_IN_REGISTER,
    const weight *w EDML_IN_REGISTER, const value *b EDML_IN_REGISTER, int inputs EDML_IN_REGISTER)
{
    __asm__("    ldr    r12, [sp]\n"
            "    push   {r5}\n"
            "    vpush  {s16-s25}\n"
            "    vldmia r3, {s0-s7}\n"
            ADD_INPUTS(ADD_TO_EIGHT_SUMS, SKIP_EIGHT)
            "    vstmia r0, {s0-s7}\n"
            "    vpop   {s16-s25}\n"
            "    pop    {r5}\n"
            "    bx     lr\n");
}
/* clang-format on */

#endif
