/* Classical multidimensional scaling (section 3.3).
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_MDS_H
#define EDML_MDS_H

#include "jacobi.h"

/* The thresholds of jacobi.h, the first three relative to the largest entry of the Gram matrix.
 * test_mds.c measures their effect on the points. */
#define MDS_ROUNDING REAL(5.9604644775390625e-8) /* 2^-24: rounding */
#define MDS_WANTED REAL(3.814697265625e-6)       /* 2^-18 */
#define MDS_UNWANTED REAL(0.0078125)             /* 2^-7 */
#define MDS_ANGLE REAL(0.0001220703125)          /* 2^-13 */

/* Double centring: the Gram matrix J A J of centred points, A = -D^2/2, has the null vector
 * (1, ..., 1).  Instead of subtracting means, reflect that vector onto the last axis: I - u u'/h
 * with u = (ALPHA, ..., ALPHA, 1 + ALPHA) and h = u'u/2 = 1 + ALPHA.  Row and column 13 are then
 * zero, and an eigenproblem of order 13 remains. */
#define ALPHA REAL(0.26726124191242438)       /* 1/sqrt(14) */
#define HOUSEHOLDER REAL(0.21089672205953698) /* ALPHA / (1 + ALPHA) */

/* gram: upper triangle of order 13.  D <= 3 m: entries before centring <= 4.5 m^2, row sums <= 58.5,
 * Frobenius norm <= 4.5 sqrt(182) = 60.7, which no projection or rotation makes larger. */
static void reduced_gram(real gram[][EDML_JOINTS], const real distance[EDML_PAIRS])
{
    enum { LAST = EDML_JOINTS - 1 };
    real row_sum[EDML_JOINTS] = {0};
    const real *d = distance;
    for (int i = 0; i < EDML_JOINTS; i++) {
        gram[i][i] = 0;
        for (int j = i + 1; j < EDML_JOINTS; j++, d++) {
            const real entry = -MUL(*d, *d) / 2;
            gram[i][j] = entry;
            row_sum[i] += entry;
            row_sum[j] += entry;
        }
    }
    /* A' = A - u q' - q u', q = p - (u'p / 2h) u, p = A u / h */
    real *const p = row_sum;
    real along = 0; /* u'p / h */
    for (int i = 0; i < EDML_JOINTS; i++) {
        p[i] = MUL(HOUSEHOLDER, row_sum[i]) + MUL(REAL(1.0) - HOUSEHOLDER, gram[i][LAST]);
        along += i < LAST ? MUL(HOUSEHOLDER, p[i]) : p[i];
    }
    for (int i = 0; i < LAST; i++)
        for (int j = i; j < LAST; j++) gram[i][j] -= MUL(ALPHA, p[i] + p[j] - MUL(ALPHA, along));
}

static real largest_entry(real a[][EDML_JOINTS], int order)
{
    real largest = 0;
    for (int i = 0; i < order; i++)
        for (int j = i; j < order; j++)
            if (ABS(a[i][j]) > largest) largest = ABS(a[i][j]);
    return largest;
}

/* Undoes the reflection: 13 entries of y in the reduced basis become 14, of the joints. */
static void expand(real y[EDML_JOINTS])
{
    real sum = 0;
    for (int i = 0; i < EDML_JOINTS - 1; i++) sum += y[i];
    const real shift = MUL(HOUSEHOLDER, sum);
    for (int i = 0; i < EDML_JOINTS - 1; i++) y[i] -= MUL(ALPHA, shift);
    y[EDML_JOINTS - 1] = -shift - MUL(ALPHA, shift);
}

static void set_coordinate(point *p, int axis, real value)
{
    if (axis == 0)
        p->x = value;
    else if (axis == 1)
        p->y = value;
    else
        p->z = value;
}

void edml_mds(point x[EDML_JOINTS], const real distance[EDML_PAIRS], edml_work *work)
{
    enum {
        ORDER = EDML_JOINTS - 1,
        ROOM = (int)(sizeof work->scratch.rotation / sizeof work->scratch.rotation[0])
    };
    real(*gram)[EDML_JOINTS] = work->io.matrix;
    reduced_gram(gram, distance);
    const real scale = largest_entry(gram, ORDER);
    const jacobi_thresholds threshold = {MUL(MDS_UNWANTED, scale) + EPSILON,
                                         MUL(MDS_WANTED, scale) + EPSILON,
                                         MUL(MDS_ROUNDING, scale) + EPSILON, MDS_ANGLE};
    const int count = diagonalise(work->scratch.rotation, ROOM, gram, ORDER, threshold);
    int axis[3];
    real length[3];
    for (int k = 0; k < 3; k++) {
        axis[k] = 0;
        for (int i = 1; i < ORDER; i++)
            if (gram[i][i] > gram[axis[k]][axis[k]]) axis[k] = i;
        const real value = gram[axis[k]][axis[k]];
        length[k] = value > 0 ? SQRT(value) : 0; /* negative: clamped */
        gram[axis[k]][axis[k]] = -scale;         /* taken */
    }
    real(*y)[EDML_JOINTS] = gram; /* a row a coordinate; the matrix has been read */
    for (int k = 0; k < 3; k++)
        for (int j = 0; j < EDML_JOINTS; j++) y[k][j] = j == axis[k] ? length[k] : 0;
    back_transform(y, 3, work->scratch.rotation, count);
    for (int k = 0; k < 3; k++) {
        expand(y[k]);
        for (int j = 0; j < EDML_JOINTS; j++) set_coordinate(&x[j], k, y[k][j]);
    }
}

#endif
