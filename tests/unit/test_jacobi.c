/* lift/jacobi.h: eigenvalues and eigenvectors, also of matrices without a single right answer.
 *
 * SPDX-License-Identifier: MIT
 */
#include "as_float.h"

enum { N = EDML_JOINTS };

static edml_matrix a;
static edml_eigen e, again;

/* ---- Matrices ---------------------------------------------------------------------------------- */

static void clear(void) { memset(&a, 0, sizeof a); }

static void set(int i, int j, float value) { a.at[i][j] = a.at[j][i] = value; }

static void set_diagonal(const float value[N])
{
    clear();
    for (int i = 0; i < N; i++) a.at[i][i] = value[i];
}

/* Entries of both signs, none of them larger than others on the average: hard for Jacobi. */
static void sign_mixed(rng *r)
{
    for (int i = 0; i < N; i++)
        for (int j = i; j < N; j++) set(i, j, gauss(r));
}

static void rank_one(rng *r)
{
    float v[N];
    for (int i = 0; i < N; i++) v[i] = gauss(r);
    for (int i = 0; i < N; i++)
        for (int j = i; j < N; j++) set(i, j, v[i] * v[j]);
}

/* Eigenvalue 3 in a random direction, 1 everywhere else. */
static void repeated(rng *r)
{
    float v[N], square = 0;
    for (int i = 0; i < N; i++) {
        v[i] = gauss(r);
        square += v[i] * v[i];
    }
    for (int i = 0; i < N; i++)
        for (int j = i; j < N; j++) set(i, j, 2 * v[i] * v[j] / square + (i == j ? 1.0F : 0.0F));
}

/* Rows and columns from 1 down to 1e-6. */
static void graded(rng *r)
{
    sign_mixed(r);
    for (int i = 0; i < N; i++)
        for (int j = i; j < N; j++) set(i, j, a.at[i][j] * powf(10, -6.0F * (float)(i + j) / (2 * N - 2)));
}

/* -D^2/2 of a person, before centring: indefinite, one negative and a few positive eigenvalues. */
static void distance_matrix(rng *r)
{
    edml_point x[N];
    float d[EDML_PAIRS];
    random_human(r, x);
    noisy_distances(r, d, x, 0.05F);
    clear();
    for (int i = 0; i < N; i++)
        for (int j = i + 1; j < N; j++) set(i, j, -d[EDML_PAIR(i, j)] * d[EDML_PAIR(i, j)] / 2);
}

static void constant(void)
{
    for (int i = 0; i < N; i++)
        for (int j = i; j < N; j++) set(i, j, 1);
}

/* Neighbours only, equal diagonal: rotations by 45 degrees throughout. */
static void chain(void)
{
    clear();
    for (int i = 0; i < N; i++) {
        set(i, i, 2);
        if (i + 1 < N) set(i, i + 1, -1);
    }
}

/* ---- What must hold ---------------------------------------------------------------------------- */

static double norm_of_a(void)
{
    double sum = 0;
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++) sum += (double)a.at[i][j] * (double)a.at[i][j];
    return sqrt(sum);
}

static void check_orthonormal(void)
{
    for (int k = 0; k < N; k++) {
        for (int l = 0; l <= k; l++) {
            double dot = 0;
            for (int i = 0; i < N; i++) dot += (double)e.vector[k][i] * (double)e.vector[l][i];
            TEST_ASSERT_ERROR_UP_TO(ORTHONORMAL_TOLERANCE, (float)(dot - (k == l)));
        }
    }
}

static void check_eigenpairs(double norm)
{
    for (int k = 0; k < N; k++) {
        for (int i = 0; i < N; i++) {
            double error = -(double)e.value[k] * (double)e.vector[k][i];
            for (int j = 0; j < N; j++) error += (double)a.at[i][j] * (double)e.vector[k][j];
            TEST_ASSERT_ERROR_UP_TO(EIGENPAIR_TOLERANCE, (float)(norm > 0 ? error / norm : error));
        }
    }
}

static void check_trace(double norm)
{
    double trace = 0;
    for (int k = 0; k < N; k++) trace += (double)e.value[k] - (double)a.at[k][k];
    TEST_ASSERT_ERROR_UP_TO(TRACE_TOLERANCE, (float)(norm > 0 ? trace / norm : trace));
}

static void check_order_and_signs(void)
{
    for (int k = 0; k < N; k++) {
        TEST_ASSERT_TRUE(k == 0 || e.value[k - 1] >= e.value[k]);
        int largest = 0;
        for (int i = 1; i < N; i++)
            if (fabsf(e.vector[k][i]) > fabsf(e.vector[k][largest])) largest = i;
        TEST_ASSERT_TRUE(e.vector[k][largest] > 0);
    }
}

static void check_all(void)
{
    const double norm = norm_of_a();
    edml_jacobi(&e, &a);
    check_orthonormal();
    check_eigenpairs(norm);
    check_trace(norm);
    check_order_and_signs();
}

static void check_family(void (*make)(rng *), int count)
{
    rng r = rng_seed(11);
    for (int n = 0; n < count; n++) {
        make(&r);
        check_all();
    }
}

/* ---- Tests ------------------------------------------------------------------------------------- */

static void sign_mixed_matrices(void) { check_family(sign_mixed, 200); }
static void rank_one_matrices(void) { check_family(rank_one, 50); }
static void repeated_eigenvalues(void) { check_family(repeated, 50); }
static void graded_matrices(void) { check_family(graded, 50); }
static void distance_matrices(void) { check_family(distance_matrix, 100); }

static void rank_one_has_one_eigenvalue_that_is_not_zero(void)
{
    rng r = rng_seed(12);
    rank_one(&r);
    check_all();
    for (int k = 1; k < N; k++) TEST_ASSERT_ERROR_UP_TO(EIGENPAIR_TOLERANCE * e.value[0], e.value[k]);
}

static void zero_matrix(void)
{
    clear();
    check_all();
    for (int k = 0; k < N; k++) TEST_ASSERT_TRUE(e.value[k] == 0);
}

static void identity_matrix(void)
{
    clear();
    for (int i = 0; i < N; i++) a.at[i][i] = 1;
    check_all();
    for (int k = 0; k < N; k++) TEST_ASSERT_TRUE(e.value[k] == 1 && e.vector[k][k] == 1);
}

static void a_diagonal_matrix_is_sorted_exactly(void)
{
    const float value[N] = {3, -1, 4, 1, -5, 9, 2, -6, 5, 3, 5, -8, 9, 7};
    const float sorted[N] = {9, 9, 7, 5, 5, 4, 3, 3, 2, 1, -1, -5, -6, -8};
    set_diagonal(value);
    check_all();
    for (int k = 0; k < N; k++) TEST_ASSERT_TRUE(e.value[k] == sorted[k]);
}

static void equal_eigenvalues_keep_the_order_of_their_axes(void)
{
    const float value[N] = {1, 2, 1, 2, 1, 2, 1, 2, 1, 2, 1, 2, 1, 2};
    set_diagonal(value);
    check_all();
    for (int k = 0; k < N; k++) TEST_ASSERT_TRUE(e.vector[k][k < 7 ? 2 * k + 1 : 2 * k - 14] == 1);
}

static void matrices_with_known_eigenvalues(void)
{
    constant();
    check_all();
    TEST_ASSERT_FLOAT_WITHIN(14 * EIGENPAIR_TOLERANCE, 14.0F, e.value[0]);
    chain();
    check_all();
    for (int k = 0; k < N; k++) { /* 2 - 2 cos(n pi / 15), n = 14 - k */
        const double value = 2 - 2 * cos((N - k) * acos(-1.0) / (N + 1));
        TEST_ASSERT_FLOAT_WITHIN(8 * EIGENPAIR_TOLERANCE, (float)value, e.value[k]);
    }
}

static void only_the_upper_triangle_is_read(void)
{
    rng r = rng_seed(13);
    sign_mixed(&r);
    edml_jacobi(&e, &a);
    for (int i = 0; i < N; i++)
        for (int j = 0; j < i; j++) a.at[i][j] = NAN;
    edml_jacobi(&again, &a);
    TEST_ASSERT_SAME_BYTES(e.value, again.value);
    TEST_ASSERT_SAME_BYTES(e.vector, again.vector);
}

static void what_the_result_held_does_not_matter(void)
{
    rng r = rng_seed(14);
    sign_mixed(&r);
    memset(&e, 0, sizeof e);
    memset(&again, 0xFF, sizeof again);
    edml_jacobi(&e, &a);
    edml_jacobi(&again, &a);
    TEST_ASSERT_SAME_BYTES(e.value, again.value);
    TEST_ASSERT_SAME_BYTES(e.vector, again.vector);
}

#ifndef EDML_TEST_Q24 /* of the range of floats */
static void scale_matrix(float scale)
{
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++) a.at[i][j] *= scale;
}

static void scaling_by_a_power_of_two_scales_values_and_keeps_vectors_bit_for_bit(void)
{
    rng r = rng_seed(15);
    for (int power = -30; power <= 30; power += 10) {
        sign_mixed(&r);
        edml_jacobi(&e, &a);
        scale_matrix(ldexpf(1, power));
        edml_jacobi(&again, &a);
        TEST_ASSERT_SAME_BYTES(e.vector, again.vector);
        for (int k = 0; k < N; k++) TEST_ASSERT_TRUE(again.value[k] == ldexpf(e.value[k], power));
    }
}

/* Beyond these, squares of entries or of what is rounded off leave the range of float32. */
static void entries_from_1e_minus_18_to_1e17(void)
{
    rng r = rng_seed(16);
    for (int power = -60; power <= 56; power += 4) {
        sign_mixed(&r);
        for (int i = 0; i < N; i++) a.at[i][i] = i % 2 ? 1.0F : 0.0F; /* equal ones too */
        scale_matrix(ldexpf(1, power));
        check_all();
    }
}

/* Whose squares are zero in float32: such entries count as zero. */
static void entries_below_1e_minus_22_are_nothing(void)
{
    rng r = rng_seed(17);
    for (int power = -64; power >= -140; power -= 4) {
        sign_mixed(&r);
        for (int i = 0; i < N; i++) a.at[i][i] = power % 8 == 0 || i % 2 == 0 ? 0.0F : 1.0F;
        scale_matrix(ldexpf(1, power));
        edml_jacobi(&e, &a);
        check_orthonormal();
        check_order_and_signs();
        for (int k = 0; k < N; k++) {
            for (int i = 0; i < N; i++) {
                double sum = 0;
                for (int j = 0; j < N; j++) sum += (double)a.at[i][j] * (double)e.vector[k][j];
                const double missed = sum - (double)e.value[k] * (double)e.vector[k][i];
                TEST_ASSERT_TRUE(fabs(missed) <= ldexp(1e-5, power) + ldexp(1, -70));
            }
        }
    }
}

static void nan_and_infinity_end_in_finite_time(void)
{
    static const float bad[] = {NAN, INFINITY, -INFINITY};
    rng r = rng_seed(18);
    for (int n = 0; n < 3; n++) {
        sign_mixed(&r);
        set(2, 5, bad[n]);
        edml_jacobi(&e, &a);
        for (int i = 0; i < N; i++)
            for (int j = i; j < N; j++) set(i, j, bad[n]);
        edml_jacobi(&e, &a);
    }
}
#endif

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(sign_mixed_matrices);
    RUN_TEST(rank_one_matrices);
    RUN_TEST(repeated_eigenvalues);
    RUN_TEST(graded_matrices);
    RUN_TEST(distance_matrices);
    RUN_TEST(rank_one_has_one_eigenvalue_that_is_not_zero);
    RUN_TEST(zero_matrix);
    RUN_TEST(identity_matrix);
    RUN_TEST(a_diagonal_matrix_is_sorted_exactly);
    RUN_TEST(equal_eigenvalues_keep_the_order_of_their_axes);
    RUN_TEST(matrices_with_known_eigenvalues);
    RUN_TEST(only_the_upper_triangle_is_read);
    RUN_TEST(what_the_result_held_does_not_matter);
#ifndef EDML_TEST_Q24
    RUN_TEST(scaling_by_a_power_of_two_scales_values_and_keeps_vectors_bit_for_bit);
    RUN_TEST(entries_from_1e_minus_18_to_1e17);
    RUN_TEST(entries_below_1e_minus_22_are_nothing);
    RUN_TEST(nan_and_infinity_end_in_finite_time);
#endif
    return UNITY_END();
}
