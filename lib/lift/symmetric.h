/* Products with a symmetric matrix A of order m <= 12, of which `a` has the upper triangle, row by row.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_SYMMETRIC_H
#define EDML_SYMMETRIC_H

#include "../geometry/vector.h"

/* product = A w, with room for 12, because some processors write four at a time, and read behind a.  Sums are within
 * sqrt(2) times the norm of A. */
static EDML_NOINLINE void multiply(real *product, const real *a, const real *w, int m)
{
    for (int i = 0; i < m; i++) {
        const real *entry = a + i; /* down the column to the diagonal, and then along the row */
        wide of_row = 0;
        int j = 0;
        for (; j < i; entry += m - ++j) of_row += EXACT(*entry, w[j]);
        for (; j < m; j++) of_row += EXACT(*entry++, w[j]);
        ASSUME(WITHIN(of_row, EXACT(REAL(45.3), REAL(1.0)))); /* |A w| <= sqrt(2) 32 */
        product[i] = FROM_EXACT(of_row);
    }
}

/* A - w q' - q w' */
static EDML_NOINLINE void subtract_outer(real *a, const real *w, const real *q, int m)
{
    for (int i = 0; i < m; i++) {
        const real wi = w[i], qi = q[i];
        int j = i;
        do { /* no row is empty, and it takes a branch less */
            const wide both = EXACT(wi, q[j]) + EXACT(qi, w[j]);
            ASSUME(WITHIN(both, EXACT(REAL(64.0), REAL(1.0)))); /* two entries, each within 32 */
            *a -= FROM_EXACT(both);
            ASSUME(WITHIN(*a, REAL(32.0))); /* no eigenvalue is beyond it */
            a++;
        } while (++j < m);
    }
}

#endif
