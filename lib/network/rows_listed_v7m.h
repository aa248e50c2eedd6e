/* add_listed() of rows_listed.h in the words of ARMv7-M without the DSP extension, such as a Cortex-M3.  gcc 12
 * keeps two pointers of the loop on the stack.
 *
 *   r0 xi     r1 x     r2 list     r3 weights     r12 a weight, lr where they are     r4 to r11  the sums
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_ROWS_LISTED_V7M_H
#define EDML_ROWS_LISTED_V7M_H

#include "weights.h"

/* clang-format off */
#ifdef EDML_BYTES
#define SHIFT_OF_INPUT "3" /* eight rows of one byte */
#define ADD_ROW(row, to, sum)                           \
    "    ldrsb  " to ", [lr, #" row "]\n"               \
    "    mla    " sum ", r0, " to ", " sum "\n"
#else
#define SHIFT_OF_INPUT "4"
#define ADD_ROW(row, to, sum)                           \
    "    ldrsh  " to ", [lr, #" row "*2]\n"             \
    "    mla    " sum ", r0, " to ", " sum "\n"
#endif

__attribute__((naked, noinline)) static void add_listed(
    value y[EDML_ROWS] EDML_IN_REGISTER, const activation *x EDML_IN_REGISTER,
    const uint8_t *list EDML_IN_REGISTER, const weight *weights EDML_IN_REGISTER,
    const value *b EDML_IN_REGISTER)
{
    __asm__("    push   {r0, r4-r11, lr}\n"
            "    ldr    r12, [sp, #40]\n" /* b */
            "    ldmia  r12, {r4-r11}\n"
            "    b      2f\n"
            "1:  add    lr, r3, lr, lsl #" SHIFT_OF_INPUT "\n"
            "    ldrsh  r0, [r1], #2\n"
            ADD_ROW("0", "r12", "r4") ADD_ROW("1", "r12", "r5") ADD_ROW("2", "r12", "r6")
            ADD_ROW("3", "r12", "r7") ADD_ROW("4", "r12", "r8") ADD_ROW("5", "r12", "r9")
            ADD_ROW("6", "r12", "r10") ADD_ROW("7", "lr", "r11")
            "2:  ldrb   lr, [r2], #1\n"
            "    cmp    lr, #255\n" /* LAST_OF_LIST */
            "    bne    1b\n"
            "    pop    {r0}\n"
            "    stmia  r0, {r4-r11}\n"
            "    pop    {r4-r11, pc}\n");
}
/* clang-format on */

#endif
