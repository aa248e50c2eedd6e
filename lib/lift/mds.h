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

/* m^2: no eigenvalue of the Gram matrix is beyond it, as lift/refine.h shows of the positive ones, and so no
 * entry is, however the matrix is turned.  Of the negative ones: u'(D^2)u <= 9 * 2 s^2, s as there. */
#define MOST_SPREAD REAL(32.0)

/* gram: upper triangle of order 13, row by row.  D <= 3 m: entries before centring <= 4.5 m^2, row sums
 * <= 58.5, Frobenius norm <= 4.5 sqrt(182) = 60.7, which no projection or rotation makes larger. */
static EDML_NOINLINE void reduced_gram(real gram[TRIANGLE], const real distance[EDML_PAIRS])
{
    enum { LAST = EDML_JOINTS - 1 };
    real row_sum[EDML_JOINTS] = {0}, last[EDML_JOINTS];
    real *g = gram;
    last[LAST] = 0;
    for (int i = 0; i < LAST; i++) {
        real of_row = row_sum[i];
        *g++ = 0;
        for (int j = i + 1; j < EDML_JOINTS; j++, distance++) {
            const real entry = -SQUARE(*distance) / 2;
            of_row += entry;
            row_sum[j] += entry;
            if (j < LAST)
                *g++ = entry;
            else
                last[i] = entry;
        }
        row_sum[i] = of_row;
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
        for (int j = i; j < LAST; j++, g++) {
            *g -= p[i] + p[j];
            ASSUME(WITHIN(*g, MOST_SPREAD)); /* an entry of the matrix, turned */
        }
}

/* Undoes the reflection: 13 points in the reduced basis become 14, of the joints. */
static void expand(point y[EDML_JOINTS])
{
    point sum = y[0];
    for (int i = 1; i < EDML_JOINTS - 1; i++) sum = plus(sum, y[i]);
    const point shift = times(HOUSEHOLDER, sum), part = times(ALPHA, shift), zero = {0, 0, 0};
    for (int i = 0; i < EDML_JOINTS - 1; i++) {
        y[i] = minus(y[i], part);
        ASSUME(ALL_WITHIN(y[i], REAL(5.71))); /* a reflection changes no length */
    }
    y[EDML_JOINTS - 1] = minus(minus(zero, shift), part);
    ASSUME(ALL_WITHIN(y[EDML_JOINTS - 1], REAL(5.71))); /* as above */
}

enum { MOST_SWEEPS = 2 };        /* for each eigenvalue; one is usual */
#define SPLIT REAL(9.5367432e-7) /* 2^-20: beside a norm of 1 this is nothing */
#define NEAR REAL(6.1035156e-5)  /* 2^-14: eigenvalues so near need not be told apart */

/* Splits the largest eigenvalue off at the head of a band of order n.  norm: what the rest of the band is divided
 * by.  0: it is not the largest one, or not split off; that is so where many eigenvalues nearly coincide, or
 * where the matrix falls into parts. */
static EDML_NOINLINE int split_largest(real *norm, edml_plane_rotation *done, int *sweeps, real *band, int n)
{
    *norm = divide_by_norm(band, n);
    *sweeps = 0;
    if (!(*norm > 0)) return 1; /* nothing is left */
    const real eigenvalue = largest_eigenvalue(band, n);
    if (!is_above_all(band, n, eigenvalue + NEAR)) return 0;
    do {
        sweep(done + *sweeps * (n - 1), band, n, eigenvalue);
        ++*sweeps;
    } while (*sweeps < MOST_SWEEPS && ABS(band[1]) > SPLIT);
    return ABS(band[1]) <= SPLIT && ABS(band[0] - eigenvalue) <= NEAR;
}

/* y: the first three eigenvectors, rows of length 1, each as long as the root of its eigenvalue, a coordinate
 * each. */
static void to_points(point y[ORDER], real *a, real *vector, int order)
{
    real length[3];
    for (int k = 0; k < 3; k++) {
        bring_largest(a, vector, order, k);
        const real value = *row_of(a, order, k);
        ASSUME(value <= MOST_SPREAD);             /* an eigenvalue */
        length[k] = value > 0 ? SQRT(value) : 0; /* negative: clamped */
    }
    for (int i = 0; i < ORDER; i++) {
        const int known = i < order;
        /* unit vectors, each as long as the root */
        y[i].x = known ? MUL_TO(REAL(5.7), length[0], vector[i]) : 0;
        y[i].y = known ? MUL_TO(REAL(5.7), length[1], vector[order + i]) : 0;
        y[i].z = known ? MUL_TO(REAL(5.7), length[2], vector[2 * order + i]) : 0;
    }
}

/* From the basis after the sweeps to that before; done: behind their last rotation. */
static EDML_NOINLINE void undo_sweeps(point y[ORDER], const edml_plane_rotation *done, const int sweeps[3])
{
    for (int k = 2; k >= 0; k--) {
        const int turns = ORDER - 1 - k;
        for (int n = sweeps[k]; n > 0; n--) {
            undo_sweep(y + k, done, turns);
            done -= turns;
        }
    }
}

/* y: the three largest eigenvectors of the Gram matrix, in this way; 0: not found.  The sweeps leave next to
 * nothing beside the diagonal of the leading 3 x 3 matrix; Jacobi's rotations take that as well, because it turns
 * the axes of eigenvalues that are near. */
static int three_largest(point y[ORDER], real *gram, real *memory, edml_plane_rotation *done)
{
    real scale = REAL(1.0), *const band = memory + 1;
    int sweeps[3];
    memory[0] = 0; /* there is no axis before the first */
    tridiagonalise(gram, band);
    for (int k = 0; k < 3; k++) {
        real norm, *const rest = band + 2 * k;
        if (!split_largest(&norm, done, &sweeps[k], rest, ORDER - k)) return 0;
        /* of the first band; the rest of a band of norm 1 has less */
        scale = MUL_TO(REAL(62.0), scale, norm);
        done += sweeps[k] * (ORDER - 1 - k);
        rest[0] = MUL_TO(MOST_SPREAD, scale, rest[0]); /* entries of the matrix, turned */
        rest[1] = MUL_TO(MOST_SPREAD, scale, rest[1]);
    }
    /* The band has been read, and its first entry and the one beside it are where they belong. */
    real *const leading = band, *const vector = band + 6;
    leading[5] = band[4];
    leading[4] = band[3];
    leading[3] = band[2];
    leading[2] = 0;
    diagonalise(leading, vector, 3);
    to_points(y, leading, vector, 3);
    undo_sweeps(y, done, sweeps);
    undo_reflections(y, gram);
    return 1;
}

/* The same by Jacobi's rotations of the whole matrix: always right, in three times the time. */
static EDML_NOINLINE void three_largest_by_jacobi(point y[ORDER], real *gram, real *vector)
{
    diagonalise(gram, vector, ORDER);
    to_points(y, gram, vector, ORDER);
}

void edml_mds(point x[EDML_JOINTS], const real distance[EDML_PAIRS], edml_work *work)
{
    real *const gram = work->of.points.stage.mds.gram;
    reduced_gram(gram, distance);
    if (!three_largest(x, gram, work->of.points.stage.mds.by.tridiagonal.band,
                       work->of.points.stage.mds.by.tridiagonal.rotation)) {
        reduced_gram(gram, distance);
        three_largest_by_jacobi(x, gram, work->of.points.stage.mds.by.vector);
    }
    expand(x);
}

#endif
