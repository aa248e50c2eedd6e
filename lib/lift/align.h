/* From the axes of the MDS to those of the points that a network gives as well, and the mean of the two.
 *
 * The MDS knows neither axes nor the mirror image.  Of all rotations, with a reflection or without, the one
 * that brings its points nearest to the network's is taken (the orthogonal Procrustes problem).
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_ALIGN_H
#define EDML_ALIGN_H

#include "../geometry/matrix3.h"
#include "../network/model.h"

typedef struct { /* a matrix by its rows */
    real at[3][3];
} small_matrix;

static INLINE_PRODUCTS real dot_rows(const real a[3], const real b[3])
{
    return FROM_EXACT(EXACT(a[0], b[0]) + EXACT(a[1], b[1]) + EXACT(a[2], b[2]));
}

/* An eighth of the sum of the products of two sets of centred points.  The squares of x add up to at most 105,
 * as those of any distances up to 3 m do, and those of onto, within 6 m on each axis, to 1512: the squares of
 * the entries of m add up to less than 50^2. */
static EDML_NOINLINE void sum_products(small_matrix *m, const point onto[EDML_JOINTS],
                                       const point x[EDML_JOINTS])
{
    matrix3 sum = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    for (int j = 0; j < EDML_JOINTS; j++) {
        const point eighth = {x[j].x / 8, x[j].y / 8, x[j].z / 8};
        add_multiple(&sum.x, onto[j].x, eighth);
        add_multiple(&sum.y, onto[j].y, eighth);
        add_multiple(&sum.z, onto[j].z, eighth);
    }
    /* as above */
    ASSUME(ALL_WITHIN(sum.x, REAL(50.0)) && ALL_WITHIN(sum.y, REAL(50.0)) && ALL_WITHIN(sum.z, REAL(50.0)));
    const small_matrix rows = {
        {{sum.x.x, sum.x.y, sum.x.z}, {sum.y.x, sum.y.y, sum.y.z}, {sum.z.x, sum.z.y, sum.z.z}}};
    *m = rows;
}

#define NO_SIZE REAL(0.000244140625) /* 2^-12: in fixed point smaller matrices lose their shape to rounding */

/* Divides a matrix by the root of the sum of its squares; returns 0 if it is zero, or nearly so. */
static EDML_NOINLINE int divide_by_size(small_matrix *m)
{
    wide squares = 0;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) squares += EXACT(m->at[i][k], m->at[i][k]);
    ASSUME(squares >= 0 && squares <= EXACT(REAL(50.0), REAL(50.0))); /* as above */
    const real size = ROOT_OF_EXACT(squares);
    if (!(size > NO_SIZE)) return 0;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) m->at[i][k] = DIV_TO(REAL(1.0), m->at[i][k], size); /* one of them */
    return 1;
}

/* ---- The nearest orthogonal matrix (F. L. Markley, "Attitude determination using vector observations: a fast
 * optimal matrix algorithm", 1993, for either sign of the determinant) -------------------------------- */

enum { NEWTON_STEPS = 16 };            /* five to eight are usual */
#define LAST_NEWTON_STEP REAL(0.00025) /* the next one is about its square over the gap of the roots */
#define LEAST_ZETA REAL(0.001953125)   /* 2^-9: people who stand straight may be below 2^-6 */

/* Of a matrix of unit size. */
static EDML_NOINLINE void cofactors(small_matrix *c, const small_matrix *m)
{
    static const uint8_t next[3] = {1, 2, 0};
    for (int i = 0; i < 3; i++) {
        const real *const a = m->at[next[i]], *const b = m->at[next[next[i]]];
        for (int k = 0; k < 3; k++) {
            const int n = next[k], p = next[n];
            c->at[i][k] = FROM_EXACT(EXACT(a[n], b[p]) - EXACT(a[p], b[n]));
            /* no more than the product of two singular values, whose squares add up to 1 */
            ASSUME(WITHIN(c->at[i][k], REAL(0.51)));
        }
    }
}

/* (p + q)(q + r)(r + p) of the singular values p, q, r, where `sum` is theirs; volume: their product. */
static real zeta_at(real sum, real volume) { return MUL(sum, SQUARE(sum) - REAL(1.0)) / 2 - volume; }

/* The sum of the singular values of a matrix of unit size: the largest root of
 * (x^2 - 1)^2 - 8 volume x - 4 squares, `squares` those of the cofactors, by Newton's method from above.  The
 * derivative is 8 zeta. */
static real sum_singular_values(real volume, real squares)
{
    real sum = REAL(1.7320508), length = REAL(1.0); /* root of 3: no sum is larger */
    for (int step = 0; step < NEWTON_STEPS && length > LAST_NEWTON_STEP; step++) {
        const real zeta = zeta_at(sum, volume), over = SQUARE(sum) - REAL(1.0);
        if (zeta < LEAST_ZETA) break;
        const real value = (SQUARE(over) - 8 * MUL(volume, sum)) / 8 - squares / 2; /* an eighth of it */
        length = DIV_TO(REAL(0.74), value, zeta); /* from root of 3 or less to 1 or more */
        sum -= length;
        ASSUME(REAL(0.99) <= sum && sum <= REAL(1.74)); /* between these, but for rounding */
    }
    return sum;
}

/* 8 factor (scale M + part C - M M'M) in the place of C. */
static EDML_NOINLINE void combine(small_matrix *c, const small_matrix *m, real scale, real part, real factor)
{
    for (int i = 0; i < 3; i++) {
        const real *const row = m->at[i];
        const real along[3] = {dot_rows(m->at[0], row), dot_rows(m->at[1], row), dot_rows(m->at[2], row)};
        for (int k = 0; k < 3; k++) {
            const real column[3] = {m->at[0][k], m->at[1][k], m->at[2][k]};
            const real entry = MUL(scale, row[k]) + MUL(part, c->at[i][k]) - dot_rows(along, column);
            c->at[i][k] = MUL_TO(REAL(1.05), factor, 8 * entry); /* of a unit vector, but for rounding */
        }
    }
}

/* Makes a matrix of unit size the nearest orthogonal one: a rotation, or a reflection as well, as its
 * determinant has it.  Returns 0 where there are many, because the matrix is of rank 1, or nearly so.  A Newton
 * step takes out what rounding left of the other factor (Higham, "Computing the polar decomposition", 1986). */
static EDML_NOINLINE int make_orthogonal(small_matrix *m)
{
    small_matrix r;
    cofactors(&r, m);
    const real determinant = dot_rows(m->at[0], r.at[0]), volume = ABS(determinant);
    const real squares = dot_rows(r.at[0], r.at[0]) + dot_rows(r.at[1], r.at[1]) + dot_rows(r.at[2], r.at[2]);
    const real sum = sum_singular_values(volume, squares), zeta = zeta_at(sum, volume);
    if (zeta < LEAST_ZETA) return 0;
    combine(&r, m, (SQUARE(sum) + REAL(1.0)) / 2, determinant < 0 ? -sum : sum, DIV(REAL(0.125), zeta));
    *m = r;
    combine(&r, m, REAL(3.0), 0, REAL(0.0625));
    *m = r;
    return 1;
}

static real blend(real share, real a, real b) { return b + MUL(share, a - b); }

void edml_align(point x[EDML_JOINTS], const point onto[EDML_JOINTS], const edml_model *model)
{
    const real share = PARAM(model->mds_share);
    small_matrix m;
    sum_products(&m, onto, x);
    const int found = divide_by_size(&m) && make_orthogonal(&m);
    for (int j = 0; j < EDML_JOINTS; j++) {
        const real p[3] = {x[j].x, x[j].y, x[j].z};
        const point to = onto[j];
        x[j].x = found ? blend(share, dot_rows(m.at[0], p), to.x) : to.x;
        x[j].y = found ? blend(share, dot_rows(m.at[1], p), to.y) : to.y;
        x[j].z = found ? blend(share, dot_rows(m.at[2], p), to.z) : to.z;
    }
}

#endif
