/* symmetric.h in float, in the words of a Cortex-M with Helium (MVE): four numbers at a time.  Each is computed as there,
 * and sums are in the same order: the same bits, as long as no product is below 1.2e-38, which Helium makes zero.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_SYMMETRIC_MVE_H
#define EDML_SYMMETRIC_MVE_H

#include "../geometry/vector.h"

/* clang-format off */

/* q2: how far each lane's own row is behind row i in a column, l (m - i - 1) - l (l - 1) / 2 for lane l. */
#define FIND_OWN_ROWS                                   \
    "    movs       r12, #0\n"                          \
    "    vidup.u32  q1, r12, #1\n"                      \
    "    vmul.i32   q2, q1, r10\n"                      \
    "    vmul.i32   q4, q1, q1\n"                       \
    "    vsub.i32   q4, q4, q1\n"                       \
    "    vshr.u32   q4, q4, #1\n"                       \
    "    vsub.i32   q2, q2, q4\n"

/* Columns i + 1 and i + 2: the first lanes read their own rows, the others still row j. */
#define ADD_AROUND_DIAGONAL(own_lanes)                  \
    "    movw       r12, #" own_lanes "\n"              \
    "    vmsr       p0, r12\n"                          \
    "    vldrw.u32  q1, [r5, q2, uxtw #2]\n"            \
    "    vldrw.u32  q4, [r6]\n"                         \
    "    vpsel      q1, q1, q4\n"                       \
    "    ldr        r9, [r8], #4\n"                     \
    "    vmul.f32   q1, q1, r9\n"                       \
    "    vadd.f32   q0, q0, q1\n"                       \
    "    adds       r5, #4\n"                           \
    "    add        r6, r7\n"                           \
    "    subs       r7, #4\n"                           \
    "    subs       r10, #1\n"                          \
    "    beq        5f\n"

/* Rows i to i + 3 at a time, a lane each, column by column.  Left of the diagonal entries of a column are beside each
 * other, in the row that has the column's number; from there on they are in rows of their own.  Lanes behind the last
 * row read what is there; product has room for them.
 *
 *   r0 product     r4 i              r6 row j, from column i on     r8 w_j     q0 sums
 *   r1 a           r5 row i, from    r7 to the next, bytes          r9 its     q2 where rows i to i + 3 are,
 *   r3 m           column j on       r10 columns left               value         from row i on */
__attribute__((naked, noinline)) static void multiply(
    real *product EDML_IN_REGISTER, const real *a EDML_IN_REGISTER, const real *w EDML_IN_REGISTER,
    int m EDML_IN_REGISTER)
{
    __asm__("    push       {r4-r10, lr}\n"
            "    vpush      {d8, d9}\n"
            "    movs       r4, #0\n"
            "1:  add        r6, r1, r4, lsl #2\n"
            "    subs       r7, r3, #1\n"
            "    lsls       r7, r7, #2\n"
            "    mov        r8, r2\n"
            "    vmov.i32   q0, #0\n"
            "    adds       r5, r4, #1\n"
            "    dls        lr, r5\n"
            "2:  vldrw.u32  q1, [r6]\n" /* j = 0 to i */
            "    ldr        r9, [r8], #4\n"
            "    add        r6, r7\n"
            "    subs       r7, #4\n"
            "    vmul.f32   q1, q1, r9\n"
            "    vadd.f32   q0, q0, q1\n"
            "    le         lr, 2b\n"
            "    sub        r5, r6, r7\n"
            "    subs       r10, r3, r4\n"
            "    subs       r10, #1\n"
            "    beq        5f\n"
            FIND_OWN_ROWS
            ADD_AROUND_DIAGONAL("0x00FF")
            ADD_AROUND_DIAGONAL("0x0FFF")
            "    dls        lr, r10\n"
            "4:  vldrw.u32  q1, [r5, q2, uxtw #2]\n" /* j = i + 3 to m - 1 */
            "    ldr        r9, [r8], #4\n"
            "    adds       r5, #4\n"
            "    vmul.f32   q1, q1, r9\n"
            "    vadd.f32   q0, q0, q1\n"
            "    le         lr, 4b\n"
            "5:  vstrw.32   q0, [r0], #16\n"
            "    adds       r4, #4\n"
            "    cmp        r4, r3\n"
            "    blt        1b\n"
            "    vpop       {d8, d9}\n"
            "    pop        {r4-r10, pc}\n");
}

/*   r0 a, r1 w, r2 q: each from row i on     r6 w_i     r12, r4, r5 along the row
 *   r3 m - i                                 r7 q_i */
__attribute__((naked, noinline)) static void subtract_outer(
    real *a EDML_IN_REGISTER, const real *w EDML_IN_REGISTER, const real *q EDML_IN_REGISTER,
    int m EDML_IN_REGISTER)
{
    __asm__("    push       {r4-r7, lr}\n"
            "1:  mov        r12, r0\n"
            "    mov        r4, r1\n"
            "    mov        r5, r2\n"
            "    ldr        r6, [r1], #4\n"
            "    ldr        r7, [r2], #4\n"
            "    dlstp.32   lr, r3\n"
            "2:  vldrw.u32  q0, [r4], #16\n"
            "    vldrw.u32  q1, [r5], #16\n"
            "    vldrw.u32  q2, [r12]\n"
            "    vmul.f32   q0, q0, r7\n"
            "    vmul.f32   q1, q1, r6\n"
            "    vadd.f32   q0, q0, q1\n"
            "    vsub.f32   q2, q2, q0\n"
            "    vstrw.32   q2, [r12], #16\n"
            "    letp       lr, 2b\n"
            "    add        r0, r0, r3, lsl #2\n"
            "    subs       r3, #1\n"
            "    bne        1b\n"
            "    pop        {r4-r7, pc}\n");
}
/* clang-format on */

#endif
