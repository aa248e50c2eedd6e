/* Householder's reduction of a symmetric matrix to a tridiagonal one, by reflections I - w w' with w'w = 2
 * (G. Golub, C. Van Loan, "Matrix Computations", 8.3.1).
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_HOUSEHOLDER_H
#define EDML_HOUSEHOLDER_H

#include "../geometry/vector.h"

enum { ORDER = EDML_JOINTS - 1, TRIANGLE = ORDER * (ORDER + 1) / 2 };

/* Makes x [m] the vector w of the reflection that turns x onto its first axis, and returns what x is there;
 * x = 0 stays zero. */
static EDML_NOINLINE real reflect_onto_first(real *x, int m)
{
    const int bits = NORMALISE(x, m);
    wide square = 0;
    for (int i = 0; i < m; i++) square += EXACT(x[i], x[i]);
    const real norm = ROOT_OF_EXACT(square); /* in fixed point 1/2 to sqrt(12) */
    if (!(norm > 0)) return 0;
    const int negative = x[0] < 0;
    x[0] += negative ? -norm : norm;
    const real scale = DIV(REAL(1.0), SQRT(MUL(norm, ABS(x[0])))); /* x'x = 2 norm |x[0]| */
    for (int i = 0; i < m; i++) x[i] = MUL(scale, x[i]);
    return SHIFT(negative ? norm : -norm, -bits);
}

/* product = A w, [m]; a: upper triangle of A, row by row.  Sums are within sqrt(2) times the norm of A. */
static EDML_NOINLINE void multiply(real *product, const real *a, const real *w, int m)
{
    wide sum[ORDER];
    for (int i = 0; i < m; i++) sum[i] = 0;
    for (int i = 0; i < m; i++) {
        const real wi = w[i];
        wide of_row = sum[i] + EXACT(*a++, wi);
        for (int j = i + 1; j < m; j++) {
            const real entry = *a++;
            of_row += EXACT(entry, w[j]);
            sum[j] += EXACT(entry, wi);
        }
        product[i] = FROM_EXACT(of_row);
    }
}

/* A - w q' - q w' */
static EDML_NOINLINE void subtract_outer(real *a, const real *w, const real *q, int m)
{
    real *entry = a;
    for (int i = 0; i < m; i++) {
        const real wi = w[i], qi = q[i];
        for (int j = i; j < m; j++) *entry++ -= FROM_EXACT(EXACT(wi, q[j]) + EXACT(qi, w[j]));
    }
}

/* a     upper triangle, row by row, of a Frobenius norm n <= 61, which no reflection changes; becomes the
 *       reflections, each behind the diagonal entry of its row
 * band  [ORDER][2] the diagonal, and beside each entry the one off the diagonal; zero beside the last
 * |A w| <= sqrt(2) n, and q is the part of A w that is at right angles to w. */
static EDML_NOINLINE void tridiagonalise(real *a, real *band)
{
    for (int m = ORDER - 1; m >= 2; m--) {
        real q[ORDER];
        real *const w = a + 1, *const rest = w + m;
        *band++ = *a;
        *band++ = reflect_onto_first(w, m);
        multiply(q, rest, w, m);
        wide along = 0;
        for (int i = 0; i < m; i++) along += EXACT(w[i], q[i]);
        const real half = FROM_EXACT(along) / 2;
        for (int i = 0; i < m; i++) q[i] -= MUL(half, w[i]);
        subtract_outer(rest, w, q, m);
        a = rest;
    }
    band[0] = a[0];
    band[1] = a[1];
    band[2] = a[2];
    band[3] = 0;
}

static EDML_NOINLINE void reflect_points(point *y, const real *w, int m)
{
    wide x_along = 0, y_along = 0, z_along = 0;
    for (int i = 0; i < m; i++) {
        x_along += EXACT(w[i], y[i].x);
        y_along += EXACT(w[i], y[i].y);
        z_along += EXACT(w[i], y[i].z);
    }
    const point along = {FROM_EXACT(x_along), FROM_EXACT(y_along), FROM_EXACT(z_along)};
    for (int i = 0; i < m; i++) y[i] = minus(y[i], times(w[i], along));
}

/* From the basis of the tridiagonal matrix to that of the matrix before, each coordinate of y [ORDER]. */
static void undo_reflections(point *y, const real *a)
{
    const real *row = a + TRIANGLE - 3; /* the last two rows have no reflection */
    for (int m = 2; m < ORDER; m++) {
        row -= m + 1;
        reflect_points(y + ORDER - m, row + 1, m);
    }
}

#endif
