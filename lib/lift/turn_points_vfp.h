/* turn_points.h in float, in the words of a Cortex-M with an FPU: a point a load.  vmla and vmls round the product before they
 * add, as C does: the same bits.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_TURN_POINTS_VFP_H
#define EDML_TURN_POINTS_VFP_H

#include "../geometry/vector.h"

/* clang-format off */

/*   r0 y     r3 y     r12 w     s0 to s2 a point      s3 its w
 *   r1 w     r2 m               s8 to s10 the sums of products */
__attribute__((naked, noinline)) static void reflect_points(
    point *y EDML_IN_REGISTER, const real *w EDML_IN_REGISTER, int m EDML_IN_REGISTER)
{
    __asm__("    movs       r3, #0\n"
            "    vmov       s8, r3\n"
            "    vmov       s9, r3\n"
            "    vmov       s10, r3\n"
            "    mov        r3, r0\n"
            "    mov        r12, r1\n"
            "    add        r2, r1, r2, lsl #2\n" /* end of w */
            "1:  vldmia     r3!, {s0-s2}\n"
            "    vldmia     r12!, {s3}\n"
            "    vmla.f32   s8, s0, s3\n"
            "    vmla.f32   s9, s1, s3\n"
            "    vmla.f32   s10, s2, s3\n"
            "    cmp        r12, r2\n"
            "    bne        1b\n"
            "2:  vldmia     r0, {s0-s2}\n"
            "    vldmia     r1!, {s3}\n"
            "    vmls.f32   s0, s8, s3\n"
            "    vmls.f32   s1, s9, s3\n"
            "    vmls.f32   s2, s10, s3\n"
            "    vstmia     r0!, {s0-s2}\n"
            "    cmp        r1, r2\n"
            "    bne        2b\n"
            "    bx         lr\n");
}

/* A coordinate: sine * next + cosine * last, and cosine * next - sine * last in the place of last. */
#define ROTATE_COORDINATE(next, last, turned)               \
    "    vmul.f32   " turned ", " next ", s9\n"             \
    "    vmla.f32   " turned ", " last ", s8\n"             \
    "    vmul.f32   " last ", " last ", s9\n"               \
    "    vnmls.f32  " last ", " next ", s8\n"

/*   r0 y             r3 the next y     s0 to s2 the last point     s8, s9 cosine and sine
 *   r1 rotations     r2 n              s3 to s5 the next one       s10 to s12 a turned one */
__attribute__((naked, noinline)) static void undo_sweep(
    point *y EDML_IN_REGISTER, const edml_plane_rotation *done EDML_IN_REGISTER, int n EDML_IN_REGISTER)
{
    __asm__("    vldmia     r0, {s0-s2}\n"
            "    add        r3, r0, #12\n"
            "1:  vldmdb     r1!, {s8, s9}\n"
            "    vldmia     r3!, {s3-s5}\n"
            ROTATE_COORDINATE("s3", "s0", "s10")
            ROTATE_COORDINATE("s4", "s1", "s11")
            ROTATE_COORDINATE("s5", "s2", "s12")
            "    vstmia     r0!, {s10-s12}\n"
            "    subs       r2, #1\n"
            "    bne        1b\n"
            "    vstmia     r0, {s0-s2}\n"
            "    bx         lr\n");
}
/* clang-format on */

#endif
