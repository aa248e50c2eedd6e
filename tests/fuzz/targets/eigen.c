/* edml_jacobi() of any symmetric matrix within its range.
 *
 * SPDX-License-Identifier: MIT
 */
#define NAME_OF_THIS eigen
#include "../native.h"

/* Any; of low rank; diagonal; of equal eigenvalues.  `scale` is the largest entry. */
static void draw_matrix(double a[EDML_JOINTS][EDML_JOINTS], double scale, choices *from)
{
    const uint32_t kind = draw_below(from, 8);
    double vector[3][EDML_JOINTS];
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < EDML_JOINTS; i++) vector[k][i] = draw_between(from, -1, 1);
    for (int i = 0; i < EDML_JOINTS; i++) {
        for (int j = i; j < EDML_JOINTS; j++) {
            double entry = draw_between(from, -1, 1);
            if (kind < 3) entry = 0;
            for (int k = 0; k < (int)kind && kind < 4; k++)
                entry += vector[k % 3][i] * vector[k % 3][j] / 4;
            if (kind == 4 && i != j) entry = 0;
            if (kind == 5) entry = i == j ? 1 : draw_one_in(from, 8) ? 1e-6 * entry : 0;
            if (kind == 6) entry *= draw_magnitude(from, 1e-8, 1);
            a[i][j] = a[j][i] = scale * entry;
        }
    }
}

/* In fixed point the Frobenius norm is limited, and errors are absolute. */
static double draw_scale(choices *from)
{
    if (IS_EXACT) return draw_magnitude(from, 0x1p-90, 0x1p55);
    return draw_magnitude(from, 0x1p-16, 90.0 / EDML_JOINTS);
}

static double norm_of(const double a[EDML_JOINTS][EDML_JOINTS])
{
    double sum = 0;
    for (int i = 0; i < EDML_JOINTS; i++)
        for (int j = 0; j < EDML_JOINTS; j++) sum += a[i][j] * a[i][j];
    return sqrt(sum);
}

static void check_vectors(const edml_eigen *eigen)
{
    for (int k = 0; k < EDML_JOINTS; k++) {
        double largest = 0;
        for (int l = 0; l <= k; l++) {
            double sum = 0;
            for (int i = 0; i < EDML_JOINTS; i++)
                sum += from_real(eigen->vector[k][i]) * from_real(eigen->vector[l][i]);
            REQUIRE(fabs(sum - (k == l)) <= 3e-5, "eigenvectors that are not orthonormal");
        }
        for (int i = 0; i < EDML_JOINTS; i++) {
            const double component = from_real(eigen->vector[k][i]);
            if (fabs(component) > fabs(largest)) largest = component;
        }
        REQUIRE(largest > 0, "the largest component is negative");
    }
}

static void check_values(const edml_eigen *eigen, const double a[EDML_JOINTS][EDML_JOINTS])
{
    const double error = (IS_EXACT ? 1e-5 : 3e-5) * norm_of(a) + (IS_EXACT ? 0x1p-70 : 1e-5);
    for (int k = 0; k < EDML_JOINTS; k++) {
        const double value = from_real(eigen->value[k]);
        REQUIRE(k == 0 || value <= from_real(eigen->value[k - 1]), "eigenvalues that are not in order");
        for (int i = 0; i < EDML_JOINTS; i++) {
            double sum = 0;
            for (int j = 0; j < EDML_JOINTS; j++) sum += a[i][j] * from_real(eigen->vector[k][j]);
            REQUIRE(fabs(sum - value * from_real(eigen->vector[k][i])) <= error, "no eigenpair");
        }
    }
}

void FUZZ_TARGET(eigen)(choices *from)
{
    double a[EDML_JOINTS][EDML_JOINTS];
    edml_matrix given;
    edml_eigen eigen;
    draw_matrix(a, draw_scale(from), from);
    for (int i = 0; i < EDML_JOINTS; i++) {
        for (int j = 0; j < EDML_JOINTS; j++) {
            given.at[i][j] = to_real(a[i][j]);
            if (j >= i) a[i][j] = a[j][i] = from_real(given.at[i][j]);
            if (j < i) given.at[i][j] = to_real(draw_extreme(from)); /* is not read */
        }
    }
    edml_jacobi(&eigen, &given);
#ifdef EDML_FUZZ_Q
    edml_eigen watched = eigen;
    WATCH(EDML_OK, (checked_jacobi(&watched, &given, &taken), EDML_OK), &eigen, &watched,
          offsetof(edml_eigen, diagonal));
#endif
    check_vectors(&eigen);
    check_values(&eigen, (const double(*)[EDML_JOINTS])a);
}
