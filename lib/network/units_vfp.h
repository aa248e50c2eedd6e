/* units_by_row.h in the words of a Cortex-M with an FPU: four rows at a time.  The ReLU is in integers, because there
 * it takes an instruction: a sum whose sign bit is set becomes zero.
 *
 *   r0, r1 where sums and differences of units go     r2, r12 sums of even and of odd inputs     r3 rows
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_UNITS_VFP_H
#define EDML_UNITS_VFP_H

#include "rows_vfp.h"

typedef char a_sum_has_64_bytes[ROWS * sizeof(value) == 64 ? 1 : -1];

/* clang-format off */
#define TAKE_POSITIVE_PART(r) "    bic    " r ", " r ", " r ", asr #31\n"
#define TAKE_POSITIVE_PARTS(s0, s1, s2, s3)                     \
    "    vmov   r4, r5, " s0 ", " s1 "\n"                       \
    "    vmov   r6, r7, " s2 ", " s3 "\n"                       \
    TAKE_POSITIVE_PART("r4") TAKE_POSITIVE_PART("r5")           \
    TAKE_POSITIVE_PART("r6") TAKE_POSITIVE_PART("r7")           \
    "    vmov   " s0 ", " s1 ", r4, r5\n"                       \
    "    vmov   " s2 ", " s3 ", r6, r7\n"
#define ADD_AND_SUBTRACT(sum, difference, a, b)                 \
    "    vadd.f32 " sum ", " a ", " b "\n"                      \
    "    vsub.f32 " difference ", " a ", " b "\n"

/* What four rows, s8 to s11, and their mirror rows, s12 to s15, sum to. */
#define TAKE_SUMS                                                                               \
    "    vldmia r2!, {s0-s3}\n"                                                                 \
    "    vldmia r12!, {s4-s7}\n"                                                                \
    ADD_AND_SUBTRACT("s8", "s12", "s0", "s4") ADD_AND_SUBTRACT("s9", "s13", "s1", "s5")         \
    ADD_AND_SUBTRACT("s10", "s14", "s2", "s6") ADD_AND_SUBTRACT("s11", "s15", "s3", "s7")

/* rows: a multiple of 4, > 0. */
__attribute__((naked, noinline)) static void activate_fours(
    value *sums EDML_IN_REGISTER, value *differences EDML_IN_REGISTER,
    value sum[2][ROWS] EDML_IN_REGISTER, int rows EDML_IN_REGISTER)
{
    __asm__("    push   {r4-r7}\n"
            "    add    r12, r2, #64\n"
            "1:\n"
            TAKE_SUMS
            TAKE_POSITIVE_PARTS("s8", "s9", "s10", "s11")
            TAKE_POSITIVE_PARTS("s12", "s13", "s14", "s15")
            ADD_AND_SUBTRACT("s0", "s4", "s8", "s12") ADD_AND_SUBTRACT("s1", "s5", "s9", "s13")
            ADD_AND_SUBTRACT("s2", "s6", "s10", "s14") ADD_AND_SUBTRACT("s3", "s7", "s11", "s15")
            "    vstmia r0!, {s0-s3}\n"
            "    vstmia r1!, {s4-s7}\n"
            "    subs   r3, #4\n"
            "    bne    1b\n"
            "    pop    {r4-r7}\n"
            "    bx     lr\n");
}
/* clang-format on */

static inline void activate_rows(activation *y, value sum[2][ROWS], const dense_layer *layer, int row,
                                 int rows, int count)
{
    (void)layer, (void)row;
    activate_fours(y, y + count, sum, rows);
}

#endif
