/* units_by_row.h in the words of a Cortex-M with the DSP extension: four rows at a time.
 *
 *   r0, r1 where sums and differences of units go     r4 to r7   sums of even inputs, then units
 *   r2 sum, r3 multipliers; r12, lr two of them       r8 to r11  of odd ones, then mirror units
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_UNITS_DSP_H
#define EDML_UNITS_DSP_H

#include "weights_integer.h"

#include "rows.h"

typedef char paired_units_have_14_bits[EDML_PAIRED_BITS == 14 ? 1 : -1];

/* clang-format off */
#define ACTIVATE_ROW(even, odd, multiplier)                         \
    "    add    " even ", " even ", " odd "\n"                      \
    "    sub    " odd ", " even ", " odd ", lsl #1\n"               \
    "    smmulr " even ", " even ", " multiplier "\n"               \
    "    smmulr " odd ", " odd ", " multiplier "\n"                 \
    "    usat   " even ", #14, " even "\n"                          \
    "    usat   " odd ", #14, " odd "\n"

/* Two units, and their mirror units, to sums and differences. */
#define PAIR_UNITS(unit, other, mirror_unit, other_mirror)                               \
    "    pkhbt  " unit ", " unit ", " other ", lsl #16\n"                                \
    "    pkhbt  " mirror_unit ", " mirror_unit ", " other_mirror ", lsl #16\n"           \
    "    ssub16 " other_mirror ", " unit ", " mirror_unit "\n"                           \
    "    sadd16 " other ", " unit ", " mirror_unit "\n"

#define ACTIVATE_FOUR                                                                    \
    "    add    r12, r2, #32\n"                                                          \
    "    ldmia  r2!, {r4-r7}\n"                                                          \
    "    ldmia  r12, {r8-r11}\n"                                                         \
    "    ldmia  r3!, {r12, lr}\n"                                                        \
    ACTIVATE_ROW("r4", "r8", "r12") ACTIVATE_ROW("r5", "r9", "lr")                       \
    "    ldmia  r3!, {r12, lr}\n"                                                        \
    ACTIVATE_ROW("r6", "r10", "r12") ACTIVATE_ROW("r7", "r11", "lr")                     \
    PAIR_UNITS("r4", "r5", "r8", "r9") PAIR_UNITS("r6", "r7", "r10", "r11")              \
    "    strd   r5, r7, [r0], #8\n"                                                      \
    "    strd   r9, r11, [r1], #8\n"

__attribute__((naked, noinline)) static void activate_eight(
    activation *sums EDML_IN_REGISTER, activation *differences EDML_IN_REGISTER,
    value sum[2][ROWS] EDML_IN_REGISTER, const int32_t *multiplier EDML_IN_REGISTER)
{
    __asm__("    push   {r4-r11, lr}\n"
            ACTIVATE_FOUR ACTIVATE_FOUR
            "    pop    {r4-r11, pc}\n");
}
/* clang-format on */

static inline void activate_rows(activation *y, value sum[2][ROWS], const dense_layer *layer, int row,
                                 int rows, int count)
{
    (void)rows;
    activate_eight(y, y + count, sum, layer->multiplier + row);
}

#endif
