/* symmetric.h in float, in the words of a Cortex-M with an FPU: four entries a load.  vmla rounds the product before it adds,
 * as C does, and sums are in the same order: the same bits.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_SYMMETRIC_VFP_H
#define EDML_SYMMETRIC_VFP_H

#include "../geometry/vector.h"

/* clang-format off */

#define ADD_ENTRY(a, w, product)                            \
    "    vmla.f32   s8, " a ", " w "\n"                     \
    "    vmla.f32   " product ", " a ", s9\n"

#define ADD_TWO_ENTRIES                                     \
    "    vldmia     r1!, {s0-s1}\n"                         \
    "    vldmia     r5!, {s4-s5}\n"                         \
    "    vldmia     r4, {s12-s13}\n"                        \
    ADD_ENTRY("s0", "s4", "s12")                            \
    ADD_ENTRY("s1", "s5", "s13")                            \
    "    vstmia     r4!, {s12-s13}\n"

#define ADD_LAST_ENTRY                                      \
    "    vldmia     r1!, {s0}\n"                            \
    "    vldr       s4, [r5]\n"                             \
    "    vldr       s12, [r4]\n"                            \
    ADD_ENTRY("s0", "s4", "s12")                            \
    "    vstr       s12, [r4]\n"

/* Row by row: an entry beside the diagonal counts in its row, and in its column's, whose sum gets it before its own row.
 *
 *   r0 product[i]     r4 product[j]     s0 to s3 entries     s8 sum of row i
 *   r1 a              r5 w[j]           s4 to s7 w[j]        s9 w[i]
 *   r2 w[i]           r6 columns left                        s12 to s15 sums of rows j
 *   r3 rows left */
__attribute__((naked, noinline)) static void multiply(
    real *product EDML_IN_REGISTER, const real *a EDML_IN_REGISTER, const real *w EDML_IN_REGISTER,
    int m EDML_IN_REGISTER)
{
    __asm__("    push       {r4-r7}\n"
            "    movs       r5, #0\n"
            "    lsls       r6, r3, #2\n"
            "1:  subs       r6, #4\n"
            "    str        r5, [r0, r6]\n"
            "    bne        1b\n"
            "2:  vldr       s8, [r0]\n"
            "    vldmia     r2!, {s9}\n"
            "    vldmia     r1!, {s0}\n" /* on the diagonal */
            "    adds       r4, r0, #4\n"
            "    mov        r5, r2\n"
            "    vmla.f32   s8, s0, s9\n"
            "    subs       r6, r3, #5\n"
            "    blt        4f\n"
            "3:  vldmia     r1!, {s0-s3}\n"
            "    vldmia     r5!, {s4-s7}\n"
            "    vldmia     r4, {s12-s15}\n"
            ADD_ENTRY("s0", "s4", "s12") ADD_ENTRY("s1", "s5", "s13")
            ADD_ENTRY("s2", "s6", "s14") ADD_ENTRY("s3", "s7", "s15")
            "    vstmia     r4!, {s12-s15}\n"
            "    subs       r6, #4\n"
            "    bge        3b\n"
            "4:  adds       r6, #2\n" /* as many as are left, less two */
            "    blt        5f\n"
            ADD_TWO_ENTRIES
            "5:  lsls       r6, #31\n"
            "    beq        6f\n"
            ADD_LAST_ENTRY
            "6:  vstmia     r0!, {s8}\n"
            "    subs       r3, #1\n"
            "    bne        2b\n"
            "    pop        {r4-r7}\n"
            "    bx         lr\n");
}

#define SUBTRACT_ENTRY(a, w, q)                             \
    "    vmul.f32   " q ", " q ", s8\n"                     \
    "    vmla.f32   " q ", " w ", s9\n"                     \
    "    vsub.f32   " a ", " a ", " q "\n"

/*   r0 a     r1 w[i]     r4 w[j]     r6 columns left     s0 to s3 w[j]     s8 w[i]     s12 to s15 entries
 *   r3 rows  r2 q[i]     r5 q[j]                         s4 to s7 q[j]     s9 q[i] */
__attribute__((naked, noinline)) static void subtract_outer(
    real *a EDML_IN_REGISTER, const real *w EDML_IN_REGISTER, const real *q EDML_IN_REGISTER,
    int m EDML_IN_REGISTER)
{
    __asm__("    push       {r4-r7}\n"
            "1:  mov        r4, r1\n"
            "    mov        r5, r2\n"
            "    vldmia     r1!, {s8}\n"
            "    vldmia     r2!, {s9}\n"
            "    subs       r6, r3, #4\n"
            "    blt        3f\n"
            "2:  vldmia     r4!, {s0-s3}\n"
            "    vldmia     r5!, {s4-s7}\n"
            "    vldmia     r0, {s12-s15}\n"
            SUBTRACT_ENTRY("s12", "s0", "s4") SUBTRACT_ENTRY("s13", "s1", "s5")
            SUBTRACT_ENTRY("s14", "s2", "s6") SUBTRACT_ENTRY("s15", "s3", "s7")
            "    vstmia     r0!, {s12-s15}\n"
            "    subs       r6, #4\n"
            "    bge        2b\n"
            "3:  adds       r6, #2\n" /* as many as are left, less two */
            "    blt        4f\n"
            "    vldmia     r4!, {s0-s1}\n"
            "    vldmia     r5!, {s4-s5}\n"
            "    vldmia     r0, {s12-s13}\n"
            SUBTRACT_ENTRY("s12", "s0", "s4") SUBTRACT_ENTRY("s13", "s1", "s5")
            "    vstmia     r0!, {s12-s13}\n"
            "4:  lsls       r6, #31\n"
            "    beq        5f\n"
            "    vldr       s0, [r4]\n"
            "    vldr       s4, [r5]\n"
            "    vldr       s12, [r0]\n"
            SUBTRACT_ENTRY("s12", "s0", "s4")
            "    vstmia     r0!, {s12}\n"
            "5:  subs       r3, #1\n"
            "    bne        1b\n"
            "    pop        {r4-r7}\n"
            "    bx         lr\n");
}
/* clang-format on */

#endif
