/* Products for ARMv6-M, which multiplies 32 by 32 bits to 32: four products of halves each.  Written in its
 * words, because the compiler calls a function for numbers of 64 bits that takes twice as long.
 *
 * SPDX-License-Identifier: MIT
 */
#include "fixed.h"

#ifdef EDML_MULTIPLY_V6M

/* r0 = a_high b_low, r1 = a_low b_high, r2 = a_low b_low, r3 = a_high b_high: high halves have the sign */
#define PRODUCTS_OF_HALVES                                                                                 \
    "    .syntax unified\n"                                                                                \
    "    push   {r4, r5}\n"                                                                                \
    "    uxth   r4, r0\n"                                                                                  \
    "    uxth   r5, r1\n"                                                                                  \
    "    asrs   r0, r0, #16\n"                                                                             \
    "    asrs   r1, r1, #16\n"                                                                             \
    "    movs   r3, r0\n"                                                                                  \
    "    muls   r3, r1\n"                                                                                  \
    "    movs   r2, r4\n"                                                                                  \
    "    muls   r2, r5\n"                                                                                  \
    "    muls   r0, r5\n"                                                                                  \
    "    muls   r1, r4\n"

/* clang-format off */
/* The 16 bits below those that the low products add to round with the rest: none of them changes it. */
__attribute__((naked)) int32_t edml__multiply_q24(int32_t a EDML_IN_REGISTER, int32_t b EDML_IN_REGISTER)
{
    __asm__(PRODUCTS_OF_HALVES
            "    lsrs   r2, r2, #16\n"
            "    adds   r2, #128\n" /* 2^23 >> 16 */
            "    uxth   r4, r0\n"
            "    adds   r2, r2, r4\n"
            "    uxth   r4, r1\n"
            "    adds   r2, r2, r4\n"
            "    asrs   r0, r0, #16\n"
            "    asrs   r1, r1, #16\n"
            "    adds   r0, r0, r1\n"
            "    adds   r0, r0, r3\n"
            "    lsls   r0, r0, #8\n"
            "    lsrs   r2, r2, #8\n"
            "    adds   r0, r0, r2\n"
            "    pop    {r4, r5}\n"
            "    bx     lr\n"
            "    .syntax divided\n");
}

__attribute__((naked)) int64_t edml__product(int32_t a EDML_IN_REGISTER, int32_t b EDML_IN_REGISTER)
{
    __asm__(PRODUCTS_OF_HALVES
            "    lsls   r4, r0, #16\n"
            "    asrs   r0, r0, #16\n"
            "    adds   r2, r2, r4\n"
            "    adcs   r3, r0\n"
            "    lsls   r4, r1, #16\n"
            "    asrs   r1, r1, #16\n"
            "    adds   r0, r2, r4\n"
            "    adcs   r1, r3\n"
            "    pop    {r4, r5}\n"
            "    bx     lr\n"
            "    .syntax divided\n");
}
/* clang-format on */

#else
typedef int products_are_inline; /* C99 wants something in every file */
#endif
