/* Eigenpairs of any symmetric matrix of a Frobenius norm up to 90: an entry beside the diagonal is there twice.
 *
 * SPDX-License-Identifier: MIT
 */
#include "proof.h"

#include "lift/jacobi.h"

int main(void)
{
    static edml_matrix a;
    static edml_eigen eigen;
    const real most = REAL(90.0), beside = REAL(63.65);
    for (int i = 0; i < EDML_JOINTS; i++) {
        a.at[i][i] = Frama_C_interval(-most, most);
        for (int j = i + 1; j < EDML_JOINTS; j++) a.at[i][j] = Frama_C_interval(-beside, beside);
        for (int j = 0; j < i; j++) a.at[i][j] = Frama_C_interval(INT32_MIN, INT32_MAX); /* not read */
    }
    edml_jacobi(&eigen, &a);
    return 0;
}
