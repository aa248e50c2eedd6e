/* Least squares by normal equations.
 *
 * A solution is a proposal: whoever asks for it compares errors before and after.  So in fixed point sums beyond 64
 * are clamped, and no input makes one overflow; a last sum beyond 64 is no solution in either arithmetic.  A person's
 * are below 10; of points that are no person's a search found 84 (tests/overflow).
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_LEAST_SQUARES_H
#define EDML_LEAST_SQUARES_H

#include "../../geometry/matrix3.h"

#define UNKNOWNS 6
#define COLUMNS 7 /* the unknowns', and the right side's */

#define SINGULAR_PIVOT REAL(0.000244140625) /* 2^-12: pivots up to this are zero */
#define MAX_SOLUTION REAL(8.0)              /* solutions beyond it are none */

static const matrix3 zero_matrix = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};

/* Takes unknown p out of the rows below; returns 0 if they are nearly singular: an entry is 64 times the pivot. */
static int eliminate(real rows[][COLUMNS], int p, int n)
{
    const real *from = rows[p], pivot = from[p];
    if (!(pivot > SINGULAR_PIVOT)) return 0;
    for (int i = p + 1; i < n; i++) {
        if (ABS(from[i]) / 64 >= pivot) return 0;
        const real ratio = DIV_TO(REAL(64.0), from[i], pivot); /* as it was compared */
        real *const row = rows[i];
        for (int k = i; k <= n; k++) row[k] = SATURATE(PRODUCT(row[k], REAL(1.0)) - PRODUCT(ratio, from[k]));
    }
    return 1;
}

/* Returns 0 if a sum is beyond 64, or MAX_SOLUTION times the pivot. */
static int divide_by_pivot(real *x, wide sum, real pivot)
{
    const wide most = PRODUCT(MAX_SOLUTION, pivot < REAL(8.0) ? pivot : REAL(8.0));
    if (!(-most < sum && sum < most)) return 0;
    *x = DIV_TO(MAX_SOLUTION, SATURATE(sum), pivot); /* as it was compared */
    return 1;
}

/* Solves A x = b for a symmetric positive A by elimination.  Row i has A's from the diagonal on, then b[i] in
 * column n.  Returns 0 if A is nearly singular, or there is no solution within MAX_SOLUTION. */
static int solve(real *x, real rows[][COLUMNS], int n)
{
    for (int p = 0; p < n; p++)
        if (!eliminate(rows, p, n)) return 0;
    for (int p = n - 1; p >= 0; p--) {
        const real *const row = rows[p];
        wide sum = PRODUCT(row[n], REAL(1.0));
        for (int k = p + 1; k < n; k++) sum -= PRODUCT(row[k], x[k]);
        if (!divide_by_pivot(&x[p], sum, row[p])) return 0;
    }
    return 1;
}

/* The same of three unknowns. */
static int solve3(point *x, const matrix3 *a, point b)
{
    real found[3], rows[3][COLUMNS] = {
                       {a->x.x, a->x.y, a->x.z, b.x}, {0, a->y.y, a->y.z, b.y}, {0, 0, a->z.z, b.z}};
    if (!solve(found, rows, 3)) return 0;
    x->x = found[0];
    x->y = found[1];
    x->z = found[2];
    return 1;
}

/* Adds a b'. */
static void add_product(matrix3 *sum, point a, point b)
{
    sum->x = plus(sum->x, times(a.x, b));
    sum->y = plus(sum->y, times(a.y, b));
    sum->z = plus(sum->z, times(a.z, b));
}

/* Normal equations of a translation and a rotation vector. */
typedef struct {
    wide translation[3][3], both[3][3], rotation[3][3]; /* both: translation times rotation */
    wide to_translation[3], to_rotation[3];
} equations;

/* Inline, so that what is added stays in registers. */
static EDML_INLINE void add_multiple_to(wide sum[3], real scale, point a)
{
    sum[0] += PRODUCT(scale, a.x);
    sum[1] += PRODUCT(scale, a.y);
    sum[2] += PRODUCT(scale, a.z);
}

static EDML_INLINE void add_product_to(wide sum[3][3], point a, point b)
{
    add_multiple_to(sum[0], a.x, b);
    add_multiple_to(sum[1], a.y, b);
    add_multiple_to(sum[2], a.z, b);
}

static EDML_INLINE void add_square_to(wide sum[3][3], point a) /* upper triangle */
{
    add_multiple_to(sum[0], a.x, a);
    sum[1][1] += PRODUCT(a.y, a.y);
    sum[1][2] += PRODUCT(a.y, a.z);
    sum[2][2] += PRODUCT(a.z, a.z);
}

/* Adds the square of what one direction misses.  It changes by `across` where joints are moved, and by `lever`
 * where they are turned. */
static void add_miss(equations *n, point across, point lever, real miss)
{
    add_square_to(n->translation, across);
    add_product_to(n->both, across, lever);
    add_square_to(n->rotation, lever);
    add_multiple_to(n->to_translation, -miss, across);
    add_multiple_to(n->to_rotation, -miss, lever);
}

/* The translation and the rotation vector with the least sum of squares; 0 if there are none.  Out of line, as its
 * locals are not needed where the stack is deepest. */
static EDML_NOINLINE int solve_step(point *translation, point *rotation, const equations *n)
{
    real x[UNKNOWNS], rows[UNKNOWNS][COLUMNS];
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            rows[i][k] = SATURATE(n->translation[i][k]);
            rows[i][3 + k] = SATURATE(n->both[i][k]);
            rows[3 + i][3 + k] = SATURATE(n->rotation[i][k]);
        }
        rows[i][UNKNOWNS] = SATURATE(n->to_translation[i]);
        rows[3 + i][UNKNOWNS] = SATURATE(n->to_rotation[i]);
    }
    if (!solve(x, rows, UNKNOWNS)) return 0;
    const point moved = {x[0], x[1], x[2]}, turned = {x[3], x[4], x[5]};
    *translation = moved;
    *rotation = turned;
    return 1;
}

#endif
