/* Distances to points, but for Jacobi's rotations, of which only what they end with is known.
 *
 * SPDX-License-Identifier: MIT
 */
#include "proof.h"

#include "lift/jacobi.h"

/* Eigenvalues and unit vectors, in the place of diagonalise(). */
static void some_eigenpairs(real a[][EDML_JOINTS], real vector[][EDML_JOINTS], int order)
{
    const real most = REAL(32.0), one = REAL(1.0);
    for (int i = 0; i < order; i++) {
        a[i][i] = Frama_C_interval(-most, most);
        for (int j = 0; j < order; j++) vector[i][j] = Frama_C_interval(-one, one);
    }
}

#define diagonalise some_eigenpairs
#include "lift/mds.h"

int main(void)
{
    static edml_work work;
    static point x[EDML_JOINTS];
    static real distance[EDML_PAIRS];
    for (int k = 0; k < EDML_PAIRS; k++) distance[k] = Frama_C_interval(0, REAL(3.0));
    edml_mds(x, distance, &work);
    for (int j = 0; j < EDML_JOINTS; j++) ASSERT(ALL_WITHIN(x[j], REAL(32.0)));
    return 0;
}
