/* Imputes missing joints: the conditional mean of a Gaussian in the image.
 *
 * The model of people's 2D joints is one Gaussian, the same for x and y.  A joint's conditional mean given
 * all the others is a weighted mean of them (tools/fitting/imputation.py).  Several missing joints depend
 * on each other as well, which makes a linear system.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_IMPUTE_H
#define EDML_IMPUTE_H

#include "../api/api.h"
#include "../geometry/seen.h"

/* The square matrix of so many fits an EDM. */
enum { MAX_IMPUTED = 9 };

#define MIN_PIVOT REAL(0.01)

/* The system of the missing joints, (1 - W) x = sum over the seen of W x: the matrix to a, the right
 * sides to where the joints will be.  |weight| < 8; the absolute values in a row add up to < 3.4. */
static void set_up_system(real *a, edml_image_point at[EDML_JOINTS], const uint8_t *missing, int count,
                          uint16_t seen, const edml_imputation *imputation)
{
    for (int p = 0; p < count; p++) {
        const int16_t *weight = imputation->weight[missing[p]];
        edml_image_point sum = {0, 0};
        for (int j = 0; j < EDML_JOINTS; j++) {
            if (!is_seen(seen, j)) continue;
            sum.u += MUL(Q12(weight[j]), at[j].u);
            sum.v += MUL(Q12(weight[j]), at[j].v);
        }
        at[missing[p]] = sum;
        for (int q = 0; q < count; q++) a[p * count + q] = -Q12(weight[missing[q]]);
        a[p * count + p] = REAL(1.0);
    }
}

static void subtract_multiple(edml_image_point *from, real part, edml_image_point at)
{
    from->u -= MUL(part, at.u);
    from->v -= MUL(part, at.v);
}

/* Gaussian elimination without pivoting.  But for the scale of its rows the matrix is a part of the
 * inverse of a covariance, so that its pivots are positive; the default imputation's are 0.04 or more.
 *   at  |u|, |v| of missing joints come out below 11 times the largest of a seen one
 *   a   [MAX_IMPUTED * MAX_IMPUTED], work memory
 * Returns 0 if a pivot is not positive. */
static EDML_NOINLINE int impute(edml_image_point at[EDML_JOINTS], uint16_t seen,
                                const edml_imputation *imputation, real *a)
{
    uint8_t missing[MAX_IMPUTED];
    int count = 0;
    for (int j = 0; j < EDML_JOINTS; j++)
        if (!is_seen(seen, j)) missing[count++] = (uint8_t)j;
    set_up_system(a, at, missing, count, seen, imputation);
    for (int p = 0; p < count; p++) {
        const real *pivot = a + p * count;
        if (!(pivot[p] > MIN_PIVOT)) return 0;
        for (int row = p + 1; row < count; row++) {
            real *below = a + row * count;
            const real part = DIV(below[p], pivot[p]);
            for (int q = p + 1; q < count; q++) below[q] -= MUL(part, pivot[q]);
            subtract_multiple(&at[missing[row]], part, at[missing[p]]);
        }
    }
    for (int p = count - 1; p >= 0; p--) {
        edml_image_point *x = &at[missing[p]];
        for (int q = p + 1; q < count; q++) subtract_multiple(x, a[p * count + q], at[missing[q]]);
        x->u = DIV(x->u, a[p * count + p]);
        x->v = DIV(x->v, a[p * count + p]);
    }
    return 1;
}

#endif
