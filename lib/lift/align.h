/* From the axes of the MDS to those of the points that a network gives as well, and the mean of the two.
 *
 * The MDS knows neither axes nor the mirror image.  Of all rotations, with a reflection or without, the one
 * that brings its points nearest to the network's is taken (the orthogonal Procrustes problem).
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_ALIGN_H
#define EDML_ALIGN_H

#include "../geometry/rotation.h"
#include "../network/model.h"

/* An eighth of the sum of the products of two sets of centred points.  The squares of x add up to at most 105,
 * as those of any distances up to 3 m do, and those of onto, within 6 m on each axis, to 1512: the squares of
 * the entries of m add up to less than 50^2. */
static EDML_NOINLINE matrix3 sum_products(const point onto[EDML_JOINTS], const point x[EDML_JOINTS])
{
    matrix3 m = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    for (int j = 0; j < EDML_JOINTS; j++) {
        const point eighth = {x[j].x / 8, x[j].y / 8, x[j].z / 8};
        add_multiple(&m.x, onto[j].x, eighth);
        add_multiple(&m.y, onto[j].y, eighth);
        add_multiple(&m.z, onto[j].z, eighth);
    }
    /* squares add up to less than that of 50 */
    ASSUME(ALL_WITHIN(m.x, REAL(50.0)) && ALL_WITHIN(m.y, REAL(50.0)) && ALL_WITHIN(m.z, REAL(50.0)));
    return m;
}

/* ---- The nearest rotation (F. L. Markley, "Attitude determination using vector observations: a fast optimal
 * matrix algorithm", 1993) ----------------------------------------------------------------------- */

enum { ROTATION_STEPS = 12 };          /* four or five are usual */
#define LAST_ROTATION_STEP REAL(0.001) /* the next one is about its square */
#define LEAST_ZETA REAL(0.015625)      /* of a matrix nearer to one of rank 1, rounding destroys too much */

/* The cofactors of a matrix of unit size, row by row. */
static matrix3 cofactors(const matrix3 *m)
{
    const matrix3 c = {cross(m->y, m->z), cross(m->z, m->x), cross(m->x, m->y)};
    /* products of two singular values, whose squares add up to 1 */
    ASSUME(ALL_WITHIN(c.x, REAL(0.51)) && ALL_WITHIN(c.y, REAL(0.51)) && ALL_WITHIN(c.z, REAL(0.51)));
    return c;
}

/* Of a matrix of unit size with the singular values p, q, r, whose determinant is not negative: at their sum it is
 * (p + q)(q + r)(r + p), and above it more. */
static real zeta_at(real sum, real determinant) { return MUL(sum, SQUARE(sum) - REAL(1.0)) / 2 - determinant; }

/* Their sum: the largest root of (x^2 - 1)^2 - 8 determinant x - 4 squares, `squares` those of the cofactors, by Newton's
 * method from above.  8 zeta is the derivative. */
static real sum_singular_values(real determinant, real squares)
{
    real sum = REAL(1.7320508), length = REAL(1.0); /* root of 3: no sum is larger */
    for (int step = 0; step < ROTATION_STEPS && length > LAST_ROTATION_STEP; step++) {
        const real zeta = zeta_at(sum, determinant), over = SQUARE(sum) - REAL(1.0);
        if (zeta < LEAST_ZETA) break;
        length = DIV_TO(REAL(0.74), (SQUARE(over) - 8 * MUL(determinant, sum)) / 8 - squares / 2, zeta);
        sum -= length; /* to the root, which is 1 or more */
        ASSUME(REAL(0.99) <= sum && sum <= REAL(1.74));
    }
    return sum;
}

/* factor (scale b + part c - M M'b) in the place of c. */
static EDML_NOINLINE void make_row(point *c, const point *b, const matrix3 *m, real scale, real part,
                                   real factor)
{
    const point along = rotate(m, *b), back = rotate_back(m, along);
    /* a row of a rotation, but for rounding */
    c->x = MUL_TO(REAL(1.01), factor, MUL(scale, b->x) + MUL(part, c->x) - back.x);
    c->y = MUL_TO(REAL(1.01), factor, MUL(scale, b->y) + MUL(part, c->y) - back.y);
    c->z = MUL_TO(REAL(1.01), factor, MUL(scale, b->z) + MUL(part, c->z) - back.z);
}

/* The same of each row of M and of C, and of the matrix M M'M. */
static EDML_NOINLINE void make_rows(matrix3 *c, const matrix3 *m, real scale, real part, real factor)
{
    make_row(&c->x, &m->x, m, scale, part, factor);
    make_row(&c->y, &m->y, m, scale, part, factor);
    make_row(&c->z, &m->z, m, scale, part, factor);
}

/* Makes a matrix of unit size, whose determinant is not negative, the nearest rotation; returns 0 where there is more than
 * one, as the matrix is of rank 1, or nearly so.  What rounding left of another factor, a Newton step takes out (Higham,
 * "Computing the polar decomposition", 1986). */
static EDML_NOINLINE int turn_to_rotation(matrix3 *m)
{
    matrix3 r = cofactors(m);
    const real squares = dot(r.x, r.x) + dot(r.y, r.y) + dot(r.z, r.z), determinant = dot(m->x, r.x);
    const real sum = sum_singular_values(determinant, squares), zeta = zeta_at(sum, determinant);
    if (zeta < LEAST_ZETA) return 0;
    make_rows(&r, m, (SQUARE(sum) + REAL(1.0)) / 2, sum, DIV(REAL(1.0), zeta));
    *m = r;
    make_rows(&r, m, REAL(3.0), 0, REAL(0.5));
    *m = r;
    return 1;
}

static void reverse(matrix3 *m)
{
    const point zero = {0, 0, 0};
    m->x = minus(zero, m->x);
    m->y = minus(zero, m->y);
    m->z = minus(zero, m->z);
}

/* The nearest rotation to a matrix, or its reverse, the rotation's, whichever is nearer; returns 0 if there is none. */
static int turn_to_orthogonal(matrix3 *m)
{
    if (!to_unit_size(m)) return 0;
    const int left_handed = dot(m->x, cross(m->y, m->z)) < 0;
    if (left_handed) reverse(m);
    if (!turn_to_rotation(m)) return 0;
    if (left_handed) reverse(m);
    return 1;
}

static real blend(real share, real a, real b) { return b + MUL(share, a - b); }

void edml_align(point x[EDML_JOINTS], const point onto[EDML_JOINTS], const edml_model *model)
{
    const real share = PARAM(model->mds_share);
    matrix3 m = sum_products(onto, x);
    const int found = turn_to_orthogonal(&m);
    for (int j = 0; j < EDML_JOINTS; j++) {
        const point to = onto[j], turned = found ? rotate(&m, x[j]) : to;
        x[j].x = blend(share, turned.x, to.x);
        x[j].y = blend(share, turned.y, to.y);
        x[j].z = blend(share, turned.z, to.z);
    }
}

#endif
