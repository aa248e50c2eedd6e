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

/* ---- The nearest orthogonal matrix (F. L. Markley, "Attitude determination using vector observations: a fast
 * optimal matrix algorithm", 1993, for either sign of the determinant) -------------------------------- */

enum { NEWTON_STEPS = 12 };          /* four or five are usual */
#define LAST_NEWTON_STEP REAL(0.001) /* the next one is about its square */
#define LEAST_ZETA REAL(0.015625)    /* of a matrix nearer to one of rank 1, rounding leaves too little */

/* Of a matrix of unit size, row by row. */
static matrix3 cofactors(const matrix3 *m)
{
    const matrix3 c = {cross(m->y, m->z), cross(m->z, m->x), cross(m->x, m->y)};
    /* products of two singular values, whose squares add up to 1 */
    ASSUME(ALL_WITHIN(c.x, REAL(0.51)) && ALL_WITHIN(c.y, REAL(0.51)) && ALL_WITHIN(c.z, REAL(0.51)));
    return c;
}

/* (p + q)(q + r)(r + p) of the singular values p, q, r, where `sum` is theirs; volume: their product. */
static real zeta_at(real sum, real volume) { return MUL(sum, SQUARE(sum) - REAL(1.0)) / 2 - volume; }

/* The sum of the singular values of a matrix of unit size: the largest root of (x^2 - 1)^2 - 8 volume x - 4 squares,
 * `squares` those of the cofactors, by Newton's method from above.  The derivative is 8 zeta. */
static real sum_singular_values(real volume, real squares)
{
    real sum = REAL(1.7320508), length = REAL(1.0); /* root of 3: no sum is larger */
    for (int step = 0; step < NEWTON_STEPS && length > LAST_NEWTON_STEP; step++) {
        const real zeta = zeta_at(sum, volume), over = SQUARE(sum) - REAL(1.0);
        if (zeta < LEAST_ZETA) break;
        length = DIV_TO(REAL(0.74), (SQUARE(over) - 8 * MUL(volume, sum)) / 8 - squares / 2, zeta);
        sum -= length; /* to the root, which is 1 or more */
        ASSUME(REAL(0.99) <= sum && sum <= REAL(1.74));
    }
    return sum;
}

/* factor (scale b + part c - M M'b) in the place of c. */
static EDML_NOINLINE void make_row(point *c, const point *b, const matrix3 *m, real scale, real part,
                                   real factor)
{
    const real x = dot(m->x, *b), y = dot(m->y, *b), z = dot(m->z, *b);
    point row = {MUL(part, c->x), MUL(part, c->y), MUL(part, c->z)};
    add_multiple(&row, scale, *b);
    add_multiple(&row, -x, m->x);
    add_multiple(&row, -y, m->y);
    add_multiple(&row, -z, m->z);
    /* a unit vector, but for rounding */
    c->x = MUL_TO(REAL(1.01), factor, row.x);
    c->y = MUL_TO(REAL(1.01), factor, row.y);
    c->z = MUL_TO(REAL(1.01), factor, row.z);
}

/* The same of all rows: factor (scale M + part C - M M'M). */
static EDML_NOINLINE void make_rows(matrix3 *c, const matrix3 *m, real scale, real part, real factor)
{
    make_row(&c->x, &m->x, m, scale, part, factor);
    make_row(&c->y, &m->y, m, scale, part, factor);
    make_row(&c->z, &m->z, m, scale, part, factor);
}

/* Makes a matrix of unit size the nearest orthogonal one: a rotation, or a reflection as well, as its determinant has it.
 * Returns 0 where there are many, because the matrix is of rank 1, or nearly so.  What rounding left of another factor, a
 * Newton step takes out (Higham, "Computing the polar decomposition", 1986). */
static EDML_NOINLINE int make_orthogonal(matrix3 *m)
{
    matrix3 r = cofactors(m);
    const real determinant = dot(m->x, r.x), volume = ABS(determinant);
    const real sum = sum_singular_values(volume, dot(r.x, r.x) + dot(r.y, r.y) + dot(r.z, r.z));
    const real zeta = zeta_at(sum, volume);
    if (zeta < LEAST_ZETA) return 0;
    make_rows(&r, m, (SQUARE(sum) + REAL(1.0)) / 2, determinant < 0 ? -sum : sum, DIV(REAL(1.0), zeta));
    *m = r;
    make_rows(&r, m, REAL(3.0), 0, REAL(0.5));
    *m = r;
    return 1;
}

static real blend(real share, real a, real b) { return b + MUL(share, a - b); }

void edml_align(point x[EDML_JOINTS], const point onto[EDML_JOINTS], const edml_model *model)
{
    const real share = PARAM(model->mds_share);
    matrix3 m = sum_products(onto, x);
    const int found = to_unit_size(&m) && make_orthogonal(&m);
    for (int j = 0; j < EDML_JOINTS; j++) {
        const point to = onto[j], turned = found ? rotate(&m, x[j]) : to;
        x[j].x = blend(share, turned.x, to.x);
        x[j].y = blend(share, turned.y, to.y);
        x[j].z = blend(share, turned.z, to.z);
    }
}

#endif
