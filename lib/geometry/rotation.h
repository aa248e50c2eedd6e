/* Rotations.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_ROTATION_H
#define EDML_ROTATION_H

#include "matrix3.h"

/* The rows of a rotation, but for rounding. */
#define ARE_UNIT_VECTORS(r)                                                                                \
    (ALL_WITHIN((r).x, REAL(1.001)) && ALL_WITHIN((r).y, REAL(1.001)) && ALL_WITHIN((r).z, REAL(1.001)))

/* The smallest rotation that brings a unit vector onto the z axis.  z.z > -1 */
static inline matrix3 rotation_onto(point z)
{
    const real ratio = DIV(REAL(1.0), REAL(1.0) + z.z);
    const real xy = MUL(ratio, MUL(z.x, z.y));
    const matrix3 rotation = {{REAL(1.0) - MUL(ratio, SQUARE(z.x)), -xy, -z.x},
                              {-xy, REAL(1.0) - MUL(ratio, SQUARE(z.y)), -z.y},
                              z};
    return rotation;
}

/* By the transposed matrix, which is a rotation's inverse. */
static point rotate_back(const matrix3 *by, point q)
{
    return plus(plus(times(q.x, by->x), times(q.y, by->y)), times(q.z, by->z));
}

static inline matrix3 transpose(const matrix3 *r)
{
    const matrix3 back = {{r->x.x, r->y.x, r->z.x}, {r->x.y, r->y.y, r->z.y}, {r->x.z, r->y.z, r->z.z}};
    return back;
}

static inline matrix3 compose(const matrix3 *second, const matrix3 *first)
{
    const matrix3 both = {rotate_back(first, second->x), rotate_back(first, second->y),
                          rotate_back(first, second->z)};
    return both;
}

/* One rotation after another.  Rounding adds up where rotations are composed again and again, and a product of
 * a product doubles it; a Newton step towards the nearest rotation (Higham, "Computing the polar decomposition",
 * 1986) takes it out: what R R' is off by, e, becomes 3/4 e^2. */
static inline matrix3 compose_rotations(const matrix3 *second, const matrix3 *first)
{
    const matrix3 r = compose(second, first);
    ASSUME(ARE_UNIT_VECTORS(r)); /* as those of both */
    const matrix3 back = transpose(&r), square = compose(&r, &back);
    const matrix3 newton = {{REAL(1.5) - square.x.x / 2, -square.x.y / 2, -square.x.z / 2},
                            {-square.y.x / 2, REAL(1.5) - square.y.y / 2, -square.y.z / 2},
                            {-square.z.x / 2, -square.z.y / 2, REAL(1.5) - square.z.z / 2}};
    const matrix3 rotation = compose(&newton, &r);
    ASSUME(ARE_UNIT_VECTORS(rotation)); /* the same, but for less */
    return rotation;
}

#endif
