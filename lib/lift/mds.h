/* Classical multidimensional scaling (section 3.3).
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_MDS_H
#define EDML_MDS_H

#include "householder.h"
#include "jacobi.h"
#include "tridiagonal.h"

/* Double centring: the Gram matrix J A J of centred points, A = -D^2/2, has the null vector
 * (1, ..., 1).  Instead of subtracting means, reflect that vector onto the last axis: I - u u'/h
 * with u = (ALPHA, ..., ALPHA, 1 + ALPHA) and h = u'u/2 = 1 + ALPHA.  Row and column 13 are then
 * zero, and an eigenproblem of order 13 remains. */
#define ALPHA REAL(0.26726124191242438)       /* 1/sqrt(14) */
#define HOUSEHOLDER REAL(0.21089672205953698) /* ALPHA / (1 + ALPHA) */

/* gram: upper triangle of order 13, row by row.  D <= 3 m: entries before centring <= 4.5 m^2, row sums
 * <= 58.5, Frobenius norm <= 4.5 sqrt(182) = 60.7, which no projection or rotation makes larger. */
static void reduced_gram(real gram[TRIANGLE], const real distance[EDML_PAIRS])
{
    enum { LAST = EDML_JOINTS - 1 };
    real row_sum[EDML_JOINTS] = {0}, last[EDML_JOINTS] = {0};
    real *g = gram;
    for (int i = 0; i < LAST; i++) {
        *g++ = 0;
        for (int j = i + 1; j < EDML_JOINTS; j++, distance++) {
            const real entry = -MUL(*distance, *distance) / 2;
            row_sum[i] += entry;
            row_sum[j] += entry;
            if (j < LAST)
                *g++ = entry;
            else
                last[i] = entry;
        }
    }
    /* A' = A - u q' - q u', q = p - (u'p / 2h) u, p = A u / h */
    real *const p = row_sum;
    real along = 0; /* u'p / h */
    for (int i = 0; i < EDML_JOINTS; i++) {
        p[i] = MUL(HOUSEHOLDER, row_sum[i]) + MUL(REAL(1.0) - HOUSEHOLDER, last[i]);
        along += i < LAST ? MUL(HOUSEHOLDER, p[i]) : p[i];
    }
    for (int i = 0; i < LAST; i++) p[i] = MUL(ALPHA, p[i] - MUL(ALPHA, along) / 2); /* q */
    g = gram;
    for (int i = 0; i < LAST; i++)
        for (int j = i; j < LAST; j++) *g++ -= p[i] + p[j];
}

/* Undoes the reflection: 13 points in the reduced basis become 14, of the joints. */
static void expand(point y[EDML_JOINTS])
{
    point sum = y[0];
    for (int i = 1; i < EDML_JOINTS - 1; i++) sum = plus(sum, y[i]);
    const point shift = times(HOUSEHOLDER, sum), part = times(ALPHA, shift), zero = {0, 0, 0};
    for (int i = 0; i < EDML_JOINTS - 1; i++) y[i] = minus(y[i], part);
    y[EDML_JOINTS - 1] = minus(minus(zero, shift), part);
}

static const uint8_t most_sweeps[3] = {2, 2, 4}; /* for each eigenvalue; one is usual */
#define SPLIT REAL(9.5367432e-7)                 /* 2^-20: beside a norm of 1 this is nothing */

/* Splits the largest eigenvalue off at the head of a band of order n.  Returns the norm by which the rest of
 * the band is divided, and the number of sweeps. */
static real split_largest(edml_plane_rotation *done, int *sweeps, int most, real *band, int n)
{
    const real norm = divide_by_norm(band, n);
    *sweeps = 0;
    if (!(norm > 0)) return 0;
    const real eigenvalue = largest_eigenvalue(band, n);
    do {
        sweep(done + *sweeps * (n - 1), band, n, eigenvalue);
        ++*sweeps;
    } while (*sweeps < most && ABS(band[1]) > SPLIT);
    return norm;
}

/* y: the eigenvectors of the leading 3 x 3 matrix, in its basis, each as long as the root of its eigenvalue, a
 * coordinate each.  The sweeps left next to nothing beside its diagonal; Jacobi's rotations take that as well. */
static void leading_points(point y[ORDER], real leading[][EDML_JOINTS], edml_jacobi_rotation done[12])
{
    const real least = MUL(leading[0][0], REAL(5.9604644775390625e-8)) + EPSILON; /* 2^-24: rounding */
    const int count = diagonalise(done, 12, leading, 3, least);
    for (int k = 0; k < 3; k++) {
        const real length = leading[k][k] > 0 ? SQRT(leading[k][k]) : 0; /* negative: clamped */
        for (int j = 0; j < 3; j++) leading[k][j] = j == k ? length : 0;
    }
    back_transform(leading, 3, done, count);
    for (int i = 0; i < ORDER; i++) {
        const point zero = {0, 0, 0}, p = {leading[0][i], leading[1][i], leading[2][i]};
        y[i] = i < 3 ? p : zero;
    }
}

/* y: the three largest eigenvectors of the Gram matrix, in the same way.  gram has room for the band behind the
 * matrix; io.matrix[11] and on, which is behind both, takes the leading matrix. */
static void three_largest(point y[ORDER], real *gram, edml_work *work)
{
    real *const band = gram + TRIANGLE, (*const leading)[EDML_JOINTS] = &work->io.matrix[11];
    edml_plane_rotation *done = work->scratch.rotation.sweep;
    real scale = REAL(1.0);
    int sweeps[3];
    tridiagonalise(gram, band);
    for (int k = 0; k < 3; k++) {
        scale = MUL(scale, split_largest(done, &sweeps[k], most_sweeps[k], band + 2 * k, ORDER - k));
        done += sweeps[k] * (ORDER - 1 - k);
        for (int j = 0; j < 3; j++) leading[k][j] = 0;
        leading[k][k] = MUL(scale, band[2 * k]);
        if (k < 2) leading[k][k + 1] = MUL(scale, band[2 * k + 1]);
    }
    leading_points(y, leading, work->scratch.rotation.jacobi);
    for (int k = 2; k >= 0; k--)
        for (int n = sweeps[k]; n > 0; n--)
            for (int i = k; i < ORDER - 1; i++) rotate_points(&y[i + 1], &y[i], *--done);
    undo_reflections(y, gram);
}

void edml_mds(point x[EDML_JOINTS], const real distance[EDML_PAIRS], edml_work *work)
{
    real *const gram = work->io.values;
    reduced_gram(gram, distance);
    three_largest(x, gram, work);
    expand(x);
}

#endif
