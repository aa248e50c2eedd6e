/* Cyclic Jacobi eigen-decomposition of a symmetric matrix of order up to 14.
 *
 * Only the upper triangle is kept.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_JACOBI_H
#define EDML_JACOBI_H

#include "../api/api.h"

enum { SWEEPS = 12 };                               /* six are usual */
#define JACOBI_ROUNDING REAL(5.9604644775390625e-8) /* 2^-24: beside the largest entry this is nothing */
#define JACOBI_NOTHING REAL(5.3e-23)                /* 2^-74: squares of smaller floats have no bits left */

/* Rotates a pair of matrix or vector entries by the angle of (cosine, sine). */
static void rotate_pair(real *p, real *q, real cosine, real sine)
{
    const real was = *p;
    *p = MUL(cosine, was) - MUL(sine, *q);
    *q = MUL(sine, was) + MUL(cosine, *q);
    ASSUME(WITHIN(*p, REAL(63.7)) && WITHIN(*q, REAL(63.7))); /* below the diagonal they are once more */
}

/* Makes a[p][q] zero by the smaller of the two possible rotations, p < q, of the matrix and of its vectors.
 * Entries stay within the matrix's Frobenius norm n, up to 90, and those beside the diagonal within
 * n / sqrt(2), as half_gap and root are. */
static void annihilate(real a[][EDML_JOINTS], real vector[][EDML_JOINTS], int order, int p, int q)
{
    const real half_gap = a[q][q] / 2 - a[p][p] / 2;
    const real root = HYPOT(half_gap, a[p][q]);
    ASSUME(WITHIN(half_gap, REAL(63.7)) && root <= REAL(63.7)); /* n / sqrt(2) */
    /* root is no less than a[p][q] */
    const real tangent = DIV_TO(REAL(1.0), a[p][q], half_gap < 0 ? half_gap - root : half_gap + root);
    const real cosine = DIV(REAL(1.0), HYPOT(REAL(1.0), tangent));
    const real sine = MUL(tangent, cosine);

    ADD_TO(REAL(90.1), a[p][p], -MUL(tangent, a[p][q])); /* entries of the matrix, turned */
    ADD_TO(REAL(90.1), a[q][q], MUL(tangent, a[p][q]));
    a[p][q] = 0;
    for (int k = 0; k < p; k++) rotate_pair(&a[k][p], &a[k][q], cosine, sine);
    for (int k = p + 1; k < q; k++) rotate_pair(&a[p][k], &a[k][q], cosine, sine);
    for (int k = q + 1; k < order; k++) rotate_pair(&a[p][k], &a[q][k], cosine, sine);
    for (int k = 0; k < order; k++) rotate_pair(&vector[p][k], &vector[q][k], cosine, sine);
}

static real largest_entry(real a[][EDML_JOINTS], int order)
{
    real largest = 0;
    for (int i = 0; i < order; i++)
        for (int j = i; j < order; j++)
            if (ABS(a[i][j]) > largest) largest = ABS(a[i][j]);
    return largest;
}

/* Leaves the eigenvalues on the diagonal of a, and row k of vector, up to `order`, is that of a[k][k]. */
static void diagonalise(real a[][EDML_JOINTS], real vector[][EDML_JOINTS], int order)
{
    const real least = MUL(largest_entry(a, order), JACOBI_ROUNDING) + EPSILON + JACOBI_NOTHING;
    for (int i = 0; i < order; i++)
        for (int j = 0; j < order; j++) vector[i][j] = i == j ? REAL(1.0) : 0;
    for (int sweep = 0, rotated = 1; sweep < SWEEPS && rotated; sweep++) {
        rotated = 0;
        for (int p = 0; p < order; p++) {
            for (int q = p + 1; q < order; q++) {
                if (ABS(a[p][q]) <= least) continue;
                annihilate(a, vector, order, p, q);
                rotated = 1;
            }
        }
    }
}

/* Exchanges eigenvalue and vector k with the ones before. */
static void bring_forward(real a[][EDML_JOINTS], real vector[][EDML_JOINTS], int order, int k)
{
    const real value = a[k][k];
    a[k][k] = a[k - 1][k - 1];
    a[k - 1][k - 1] = value;
    for (int j = 0; j < order; j++) {
        const real was = vector[k][j];
        vector[k][j] = vector[k - 1][j];
        vector[k - 1][j] = was;
    }
}

/* Brings the largest eigenvalue from k on to k; equal ones stay in their order. */
static void bring_largest(real a[][EDML_JOINTS], real vector[][EDML_JOINTS], int order, int k)
{
    int best = k;
    for (int i = k + 1; i < order; i++)
        if (a[i][i] > a[best][best]) best = i;
    for (; best > k; best--) bring_forward(a, vector, order, best);
}

static void make_largest_positive(real vector[EDML_JOINTS])
{
    int largest = 0;
    for (int i = 1; i < EDML_JOINTS; i++)
        if (ABS(vector[i]) > ABS(vector[largest])) largest = i;
    if (vector[largest] >= 0) return;
    for (int i = 0; i < EDML_JOINTS; i++) vector[i] = -vector[i];
}

void edml_jacobi(edml_eigen *eigen, const edml_matrix *a)
{
    eigen->diagonal = *a;
    diagonalise(eigen->diagonal.at, eigen->vector, EDML_JOINTS);
    for (int k = 0; k < EDML_JOINTS; k++) {
        bring_largest(eigen->diagonal.at, eigen->vector, EDML_JOINTS, k);
        eigen->value[k] = eigen->diagonal.at[k][k];
        make_largest_positive(eigen->vector[k]);
    }
}

#endif
