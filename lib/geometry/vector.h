/* Vectors of three.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_VECTOR_H
#define EDML_VECTOR_H

#include "../api/api.h"

static inline point plus(point a, point b)
{
    const point sum = {a.x + b.x, a.y + b.y, a.z + b.z};
    return sum;
}

static inline point minus(point a, point b)
{
    const point difference = {a.x - b.x, a.y - b.y, a.z - b.z};
    return difference;
}

static inline point times(real scale, point a)
{
    const point product = {MUL(scale, a.x), MUL(scale, a.y), MUL(scale, a.z)};
    return product;
}

static inline point midpoint(point a, point b)
{
    const point half = {(a.x + b.x) / 2, (a.y + b.y) / 2, (a.z + b.z) / 2};
    return half;
}

static EDML_INLINE void add_multiple(point *sum, real scale, point a)
{
    sum->x += MUL(scale, a.x);
    sum->y += MUL(scale, a.y);
    sum->z += MUL(scale, a.z);
}

static EDML_INLINE real dot(point a, point b)
{
    return FROM_EXACT(EXACT(a.x, b.x) + EXACT(a.y, b.y) + EXACT(a.z, b.z));
}

static inline real norm(point a) { return NORM(a.x, a.y, a.z); }

static inline point over(point a, real divisor) /* |a| / 12 < divisor */
{
    /* callers say why */
    const point quotient = {DIV_TO(REAL(12.0), a.x, divisor), DIV_TO(REAL(12.0), a.y, divisor),
                            DIV_TO(REAL(12.0), a.z, divisor)};
    return quotient;
}

/* a over its length, > 0, or over that of a vector with a among its parts.  Rounded down, a length is no less
 * than any component. */
static inline point over_length(point a, real length)
{
    /* no component is longer than the vector */
    const point unit = {DIV_TO(REAL(1.0), a.x, length), DIV_TO(REAL(1.0), a.y, length),
                        DIV_TO(REAL(1.0), a.z, length)};
    return unit;
}

/* The unit vector; zero where there is no length.  |a| < 64. */
static inline point direction(point a)
{
    const point zero = {0, 0, 0};
    const real length = norm(a);
    return length > EPSILON ? over_length(a, length) : zero;
}

static inline point cross(point a, point b)
{
    const point product = {MUL(a.y, b.z) - MUL(a.z, b.y), MUL(a.z, b.x) - MUL(a.x, b.z),
                           MUL(a.x, b.y) - MUL(a.y, b.x)};
    return product;
}

#endif
