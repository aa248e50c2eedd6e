/* dot8.h for 16-bit weights in the words of a Cortex-M with the DSP extension: two weights a load,
 * and a multiplication that takes either half of it.  The same integers, hence the same bits.
 *
 *   r0 y, then xi     r2 w            r4 to r11  the sums
 *   r1 x              r3, r12 weights lr         the end of x
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_DOT8_DSP_H
#define EDML_DOT8_DSP_H

#include "weights.h"

#define IN_REGISTER __attribute__((unused)) /* which the compiler does not see */

__attribute__((naked, noinline)) static void dot8(value y[EDML_ROWS] IN_REGISTER,
                                                  const value *x IN_REGISTER, const weight *w IN_REGISTER,
                                                  const value *b IN_REGISTER, int inputs IN_REGISTER)
{
    __asm__("    push   {r0, r4-r11, lr}\n"
            "    ldr    lr, [sp, #40]\n"
            "    add    lr, r1, lr, lsl #2\n"
            "    ldmia  r3, {r4-r11}\n"
            "1:  ldr    r0, [r1], #4\n"
            "    cbz    r0, 3f\n"
            "    ldmia  r2!, {r3, r12}\n"
            "    smlabb r4, r3, r0, r4\n"
            "    smlatb r5, r3, r0, r5\n"
            "    smlabb r6, r12, r0, r6\n"
            "    smlatb r7, r12, r0, r7\n"
            "    ldmia  r2!, {r3, r12}\n"
            "    smlabb r8, r3, r0, r8\n"
            "    smlatb r9, r3, r0, r9\n"
            "    smlabb r10, r12, r0, r10\n"
            "    smlatb r11, r12, r0, r11\n"
            "    cmp    r1, lr\n"
            "    bne    1b\n"
            "2:  pop    {r0}\n"
            "    stmia  r0, {r4-r11}\n"
            "    pop    {r4-r11, pc}\n"
            "3:  adds   r2, #16\n" /* a zero, as most are */
            "    cmp    r1, lr\n"
            "    bne    1b\n"
            "    b      2b\n");
}

#endif
