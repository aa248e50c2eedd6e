/* Cyclic Jacobi eigen-decomposition of a symmetric matrix of order up to 14.
 *
 * Only the upper triangle is kept.  Vectors are not carried along: the rotations are recorded,
 * and each wanted vector is a unit vector that is transformed back through them.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_JACOBI_H
#define EDML_JACOBI_H

#include "../api/api.h"

enum { SWEEPS = 12 }; /* six are usual */

/* Rotates a pair of matrix or vector entries by the angle of (cosine, sine). */
static void rotate_pair(real *p, real *q, real cosine, real sine)
{
    const real was = *p;
    *p = MUL(cosine, was) - MUL(sine, *q);
    *q = MUL(sine, was) + MUL(cosine, *q);
}

/* Makes a[p][q] zero by the smaller of the two possible rotations, p < q.  Entries stay within
 * the matrix's Frobenius norm n, and two of them within sqrt(2) n: half_gap and root are at most
 * n / sqrt(2), their sum at most sqrt(2) n. */
static edml_jacobi_rotation annihilate(real a[][EDML_JOINTS], int order, int p, int q)
{
    const real half_gap = a[q][q] / 2 - a[p][p] / 2;
    const real root = HYPOT(half_gap, a[p][q]);
    const real tangent = DIV(a[p][q], half_gap < 0 ? half_gap - root : half_gap + root); /* to 1 */
    const real cosine = DIV(REAL(1.0), HYPOT(REAL(1.0), tangent));
    const real sine = MUL(tangent, cosine);

    a[p][p] -= MUL(tangent, a[p][q]);
    a[q][q] += MUL(tangent, a[p][q]);
    a[p][q] = 0;
    for (int k = 0; k < p; k++) rotate_pair(&a[k][p], &a[k][q], cosine, sine);
    for (int k = p + 1; k < q; k++) rotate_pair(&a[p][k], &a[k][q], cosine, sine);
    for (int k = q + 1; k < order; k++) rotate_pair(&a[p][k], &a[q][k], cosine, sine);

    edml_jacobi_rotation done;
    done.sine = sine;
    done.p = (uint8_t)p;
    done.q = (uint8_t)q;
    return done;
}

/* Skips entries of up to `least`.  Stops after SWEEPS sweeps or `room` rotations; returns the number of
 * rotations. */
static int diagonalise(edml_jacobi_rotation done[], int room, real a[][EDML_JOINTS], int order, real least)
{
    int count = 0;
    for (int sweep = 0; sweep < SWEEPS; sweep++) {
        const int before = count;
        for (int p = 0; p < order; p++) {
            for (int q = p + 1; q < order; q++) {
                if (ABS(a[p][q]) <= least) continue;
                if (count == room) return count;
                done[count++] = annihilate(a, order, p, q);
            }
        }
        if (count == before) break;
    }
    return count;
}

/* Transforms vectors of the last basis back to the first one. */
static void back_transform(real vector[][EDML_JOINTS], int vectors, const edml_jacobi_rotation done[],
                           int count)
{
    for (int n = count - 1; n >= 0; n--) {
        const real sine = done[n].sine; /* the cosine is positive: the smaller rotation was taken */
        const real cosine = SQRT(REAL(1.0) - MUL(sine, sine));
        for (int k = 0; k < vectors; k++)
            rotate_pair(&vector[k][done[n].p], &vector[k][done[n].q], cosine, -sine);
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
    enum { ROOM = (int)(sizeof eigen->rotation / sizeof eigen->rotation[0]) };
    real scale = 0;
    for (int i = 0; i < EDML_JOINTS; i++) {
        for (int j = i; j < EDML_JOINTS; j++) {
            eigen->vector[i][j] = a->at[i][j]; /* work on a copy, where the vectors will be */
            if (ABS(a->at[i][j]) > scale) scale = ABS(a->at[i][j]);
        }
    }
    const real least = MUL(scale, REAL(5.9604644775390625e-8)) + EPSILON; /* 2^-24: rounding */
    const int count = diagonalise(eigen->rotation, ROOM, eigen->vector, EDML_JOINTS, least);

    uint8_t axis[EDML_JOINTS];
    for (int i = 0; i < EDML_JOINTS; i++) { /* insertion sort, stable */
        const real value = eigen->vector[i][i];
        int k = i;
        for (; k > 0 && eigen->value[k - 1] < value; k--) {
            eigen->value[k] = eigen->value[k - 1];
            axis[k] = axis[k - 1];
        }
        eigen->value[k] = value;
        axis[k] = (uint8_t)i;
    }
    for (int k = 0; k < EDML_JOINTS; k++)
        for (int i = 0; i < EDML_JOINTS; i++) eigen->vector[k][i] = i == axis[k] ? REAL(1.0) : 0;
    back_transform(eigen->vector, EDML_JOINTS, eigen->rotation, count);
    for (int k = 0; k < EDML_JOINTS; k++) make_largest_positive(eigen->vector[k]);
}

#endif
