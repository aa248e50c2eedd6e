/* add_listed() of rows_listed.h in the words of ARMv6-M, such as a Cortex-M0+: the sums stay in registers, two weights of
 * 16 bits or four of 8 bits come in a load.
 *
 *   r0 xi     r1 x     r2 list     r4 w, r5 some of them, r6 one     r3, r8 to r10, r7, r11, r12, lr  the sums
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_ROWS_LISTED_V6M_H
#define EDML_ROWS_LISTED_V6M_H

#include "weights.h"

/* clang-format off */
#define ADD_PRODUCT(sum, w)                     \
    "    muls   " w ", r0\n"                    \
    "    add    " sum ", " w "\n"
#ifdef EDML_BYTES
#define SHIFT_OF_INPUT "3" /* eight rows of one byte */
#define MIDDLE_BYTE(left)                       \
    "    lsls   r6, r5, #" left "\n"            \
    "    asrs   r6, r6, #24\n"
#define ADD_FOUR(place, a, b, c, d)             \
    "    ldr    r5, [r4, #" place "]\n"         \
    "    sxtb   r6, r5\n" ADD_PRODUCT(a, "r6")  \
    MIDDLE_BYTE("16") ADD_PRODUCT(b, "r6")      \
    MIDDLE_BYTE("8") ADD_PRODUCT(c, "r6")       \
    "    asrs   r5, r5, #24\n" ADD_PRODUCT(d, "r5")
#define ADD_EIGHT ADD_FOUR("0", "r3", "r8", "r9", "r7") ADD_FOUR("4", "r10", "r11", "r12", "lr")
#else
#define SHIFT_OF_INPUT "4"
#define ADD_TWO(place, a, b)                    \
    "    ldr    r5, [r4, #" place "]\n"         \
    "    sxth   r6, r5\n" ADD_PRODUCT(a, "r6")  \
    "    asrs   r5, r5, #16\n" ADD_PRODUCT(b, "r5")
#define ADD_EIGHT                                                       \
    ADD_TWO("0", "r3", "r8") ADD_TWO("4", "r9", "r7")                   \
    ADD_TWO("8", "r10", "r11") ADD_TWO("12", "r12", "lr")
#endif

#define LOAD_SUMS /* from r4 */                 \
    "    ldmia  r4!, {r3, r5, r6, r7}\n"        \
    "    mov    r8, r5\n"                       \
    "    mov    r9, r6\n"                       \
    "    ldmia  r4!, {r0, r5, r6}\n"            \
    "    mov    r10, r0\n"                      \
    "    mov    r11, r5\n"                      \
    "    mov    r12, r6\n"                      \
    "    ldr    r4, [r4]\n"                     \
    "    mov    lr, r4\n"

#define STORE_SUMS /* to r4; x and list are done with */ \
    "    mov    r5, r8\n"                       \
    "    mov    r6, r9\n"                       \
    "    stmia  r4!, {r3, r5, r6, r7}\n"        \
    "    mov    r0, r10\n"                      \
    "    mov    r1, r11\n"                      \
    "    mov    r2, r12\n"                      \
    "    mov    r3, lr\n"                       \
    "    stmia  r4!, {r0-r3}\n"

__attribute__((naked, noinline)) static void add_listed(
    value y[EDML_ROWS] EDML_IN_REGISTER, const activation *x EDML_IN_REGISTER,
    const uint8_t *list EDML_IN_REGISTER, const weight *weights EDML_IN_REGISTER,
    const value *b EDML_IN_REGISTER)
{
    __asm__("    .syntax unified\n"
            "    push   {r0, r4-r7, lr}\n"
            "    mov    r4, r8\n"
            "    mov    r5, r9\n"
            "    mov    r6, r10\n"
            "    mov    r7, r11\n"
            "    push   {r4-r7}\n"
            "    push   {r3}\n" /* [sp] weights, [sp, #20] y, [sp, #44] b */
            "    ldr    r4, [sp, #44]\n"
            LOAD_SUMS
            "    b      2f\n"
            "1:  adds   r2, #1\n"
            "    lsls   r4, r4, #" SHIFT_OF_INPUT "\n"
            "    ldr    r5, [sp]\n"
            "    adds   r4, r4, r5\n"
            "    ldrh   r0, [r1]\n"
            "    sxth   r0, r0\n"
            "    adds   r1, #2\n"
            ADD_EIGHT
            "2:  ldrb   r4, [r2]\n"
            "    cmp    r4, #255\n" /* LAST_OF_LIST */
            "    bne    1b\n"
            "    ldr    r4, [sp, #20]\n"
            STORE_SUMS
            "    add    sp, #4\n"
            "    pop    {r4-r7}\n"
            "    mov    r8, r4\n"
            "    mov    r9, r5\n"
            "    mov    r10, r6\n"
            "    mov    r11, r7\n"
            "    pop    {r0, r4-r7, pc}\n"
            "    .syntax divided\n");
}
/* clang-format on */

#endif
