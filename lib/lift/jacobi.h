/* Cyclic Jacobi eigen-decomposition of a symmetric matrix of order up to 14.
 *
 * A symmetric matrix is its upper triangle, row by row from the diagonal on.
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
static INLINE_PRODUCTS void rotate_pair(real *p, real *q, real cosine, real sine)
{
    const real was = *p;
    *p = FROM_EXACT(EXACT(cosine, was) - EXACT(sine, *q));
    *q = FROM_EXACT(EXACT(sine, was) + EXACT(cosine, *q));
    ASSUME(WITHIN(*p, REAL(63.7)) && WITHIN(*q, REAL(63.7))); /* below the diagonal they are once more */
}

/* Row k of the triangle, which begins at the diagonal. */
static real *row_of(real *a, int order, int k) { return a + k * (2 * order - k + 1) / 2; }

/* Makes entry (p, q) zero by the smaller of the two possible rotations, p < q, of the matrix and of its
 * vectors.  Entries stay within the matrix's Frobenius norm n, up to 90, and those beside the diagonal within
 * n / sqrt(2), as half_gap and root are. */
static void annihilate(real *a, real *vector, int order, int p, int q)
{
    real *const of_p = row_of(a, order, p), *const of_q = row_of(a, order, q), *const entry = of_p + q - p;
    const real half_gap = *of_q / 2 - *of_p / 2;
    const real root = HYPOT(half_gap, *entry);
    ASSUME(WITHIN(half_gap, REAL(63.7)) && root <= REAL(63.7)); /* n / sqrt(2) */
    /* root is no less than the entry */
    const real tangent = DIV_TO(REAL(1.0), *entry, half_gap < 0 ? half_gap - root : half_gap + root);
    const real cosine = DIV(REAL(1.0), HYPOT(REAL(1.0), tangent));
    const real sine = MUL(tangent, cosine);

    ADD_TO(REAL(90.1), *of_p, -MUL(tangent, *entry)); /* entries of the matrix, turned */
    ADD_TO(REAL(90.1), *of_q, MUL(tangent, *entry));
    *entry = 0;
    real *at_p = a + p, *at_q = a + q; /* down columns p and q to the diagonal, and then along the rows */
    for (int k = 0; k < order; k++) {
        if (k != p && k != q) rotate_pair(at_p, at_q, cosine, sine);
        rotate_pair(vector + p * order + k, vector + q * order + k, cosine, sine);
        at_p += k < p ? order - 1 - k : 1;
        at_q += k < q ? order - 1 - k : 1;
    }
}

static real largest_entry(const real *a, int order)
{
    real largest = 0;
    for (int i = 0; i < order; i++)
        for (int j = i; j < order; j++, a++)
            if (ABS(*a) > largest) largest = ABS(*a);
    return largest;
}

/* Leaves the eigenvalues on the diagonal of a, and row k of vector [order][order] is that of eigenvalue k. */
static void diagonalise(real *a, real *vector, int order)
{
    const real least = MUL(largest_entry(a, order), JACOBI_ROUNDING) + EPSILON + JACOBI_NOTHING;
    for (int i = 0; i < order; i++)
        for (int j = 0; j < order; j++) vector[i * order + j] = i == j ? REAL(1.0) : 0;
    for (int sweep = 0, rotated = 1; sweep < SWEEPS && rotated; sweep++) {
        rotated = 0;
        for (int p = 0; p < order; p++) {
            for (int q = p + 1; q < order; q++) {
                if (ABS(row_of(a, order, p)[q - p]) <= least) continue;
                annihilate(a, vector, order, p, q);
                rotated = 1;
            }
        }
    }
}

static void exchange(real *p, real *q)
{
    const real was = *p;
    *p = *q;
    *q = was;
}

/* Brings the largest eigenvalue from k on to k, and its vector; equal ones stay in their order. */
static void bring_largest(real *a, real *vector, int order, int k)
{
    int best = k;
    for (int i = k + 1; i < order; i++)
        if (*row_of(a, order, i) > *row_of(a, order, best)) best = i;
    for (; best > k; best--) {
        exchange(row_of(a, order, best), row_of(a, order, best - 1));
        for (int j = 0; j < order; j++)
            exchange(vector + best * order + j, vector + (best - 1) * order + j);
    }
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
    real *const triangle = eigen->diagonal.at[0], *const vector = eigen->vector[0], *entry = triangle;
    for (int i = 0; i < EDML_JOINTS; i++)
        for (int j = i; j < EDML_JOINTS; j++) *entry++ = a->at[i][j];
    diagonalise(triangle, vector, EDML_JOINTS);
    for (int k = 0; k < EDML_JOINTS; k++) {
        bring_largest(triangle, vector, EDML_JOINTS, k);
        eigen->value[k] = *row_of(triangle, EDML_JOINTS, k);
        make_largest_positive(eigen->vector[k]);
    }
}

#endif
