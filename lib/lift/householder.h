/* Householder's reduction of a symmetric matrix to a tridiagonal one, by reflections I - w w' with w'w = 2
 * (G. Golub, C. Van Loan, "Matrix Computations", 8.3.1).
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_HOUSEHOLDER_H
#define EDML_HOUSEHOLDER_H

#include "../geometry/vector.h"

#if BY_HELIUM
#include "symmetric_mve.h"
#include "turn_points_vfp.h"
#elif BY_VFP
#include "symmetric_vfp.h"
#include "turn_points_vfp.h"
#else
#include "symmetric.h"
#include "turn_points.h"
#endif

#define LONGEST_REFLECTOR REAL(1.415) /* root of 2, and rounding */

enum { ORDER = EDML_JOINTS - 1, TRIANGLE = ORDER * (ORDER + 1) / 2 };

/* Makes x [m] the vector w of the reflection that turns x onto its first axis, and returns what x is there;
 * x = 0 stays zero. */
static EDML_NOINLINE real reflect_onto_first(real *x, int m)
{
    const int bits = NORMALISE(x, m);
    wide square = 0;
    for (int i = 0; i < m; i++) square += EXACT(x[i], x[i]);
    ASSUME(square >= 0); /* a sum of squares */
    const real norm = ROOT_OF_EXACT(square); /* in fixed point 1/2 to sqrt(12) */
    if (!(norm > 0)) return 0;
    const int negative = x[0] < 0;
    x[0] += negative ? -norm : norm;
    const real half = MUL(norm, ABS(x[0])); /* of x'x */
    ASSUME(half >= REAL(0.24)); /* |x[0]| >= norm >= 1/2 */
    const real scale = DIV(REAL(1.0), SQRT(half));
    for (int i = 0; i < m; i++) {
        x[i] = MUL(scale, x[i]);
        ASSUME(WITHIN(x[i], LONGEST_REFLECTOR)); /* w'w = 2 */
    }
    return SHIFT_TO(REAL(62.0), negative ? norm : -norm, -bits); /* no row is longer than the matrix */
}

/* a     upper triangle, row by row, of a Frobenius norm n <= 61, which no reflection changes; becomes the
 *       reflections, each behind the diagonal entry of its row
 * band  [ORDER][2] the diagonal, and beside each entry the one off the diagonal; zero beside the last
 * |A w| <= sqrt(2) n, and q is the part of A w that is at right angles to w. */
static EDML_NOINLINE void tridiagonalise(real *a, real *band)
{
    for (int m = ORDER - 1; m >= 2; m--) {
        real q[ORDER - 1];
        real *const w = a + 1, *const rest = w + m;
        *band++ = *a;
        *band++ = reflect_onto_first(w, m);
        multiply(q, rest, w, m);
        wide along = 0;
        for (int i = 0; i < m; i++) along += EXACT(w[i], q[i]);
        ASSUME(WITHIN(along, EXACT(REAL(64.1), REAL(1.0)))); /* w'A w, w'w = 2 */
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
