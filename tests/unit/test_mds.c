/* lift/mds.h: points from distances, also beside those of the full Jacobi decomposition.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>

#include "as_float.h"

static edml_work work;
static edml_point x[EDML_JOINTS], y[EDML_JOINTS];
static float distance[EDML_PAIRS], found[EDML_PAIRS];

static void check_recovers(const edml_point points[EDML_JOINTS])
{
    pair_distances(distance, points);
    edml_mds(x, distance, &work);
    TEST_ASSERT_ERROR_UP_TO(MDS_TOLERANCE, worst_distance_error(x, distance));
}

/* ---- Exact distances --------------------------------------------------------------------------- */

static void a_person_comes_back(void)
{
    human_pose(y);
    check_recovers(y);
}

static void random_people_come_back(void)
{
    rng r = rng_seed(21);
    for (int n = 0; n < 300; n++) {
        random_human(&r, y);
        check_recovers(y);
    }
}

static void random_points_come_back(void)
{
    rng r = rng_seed(22);
    for (int n = 0; n < 300; n++) {
        random_points(&r, y, 1);
        check_recovers(y);
    }
}

static void points_in_a_plane_come_back_flat(void)
{
    rng r = rng_seed(23);
    random_points(&r, y, 1);
    for (int j = 0; j < EDML_JOINTS; j++) y[j].z = 0.3F * y[j].x;
    check_recovers(y);
    for (int j = 0; j < EDML_JOINTS; j++) TEST_ASSERT_ERROR_UP_TO(MDS_FLAT_TOLERANCE, x[j].z);
}

static void points_on_a_line_come_back_straight(void)
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        y[j].x = (float)(j * j) * 0.01F;
        y[j].y = -2 * y[j].x;
        y[j].z = y[j].x;
    }
    check_recovers(y);
    for (int j = 0; j < EDML_JOINTS; j++) {
        TEST_ASSERT_ERROR_UP_TO(MDS_FLAT_TOLERANCE, x[j].y);
        TEST_ASSERT_ERROR_UP_TO(MDS_FLAT_TOLERANCE, x[j].z);
    }
}

static void no_distance_gives_points_at_the_origin(void)
{
    memset(distance, 0, sizeof distance);
    edml_mds(x, distance, &work);
    for (int j = 0; j < EDML_JOINTS; j++) TEST_ASSERT_TRUE(x[j].x == 0 && x[j].y == 0 && x[j].z == 0);
}

/* Every joint 4 m from every other: the largest the header allows; 13 equal eigenvalues. */
static void the_largest_distances_give_finite_points(void)
{
    for (int n = 0; n < EDML_PAIRS; n++) distance[n] = 4;
    edml_mds(x, distance, &work);
    TEST_ASSERT_TRUE(all_finite(x, 3 * EDML_JOINTS));
    TEST_ASSERT_ERROR_UP_TO(4, worst_distance_error(x, distance));
}

#ifndef EDML_TEST_Q24 /* whose error is absolute */
/* The smaller the person, the smaller the error: down to where squares leave float32. */
static void tiny_people_come_back(void)
{
    for (int power = -4; power >= -28; power -= 4) {
        human_pose(y);
        for (int j = 0; j < EDML_JOINTS; j++) {
            y[j].x = ldexpf(y[j].x, power);
            y[j].y = ldexpf(y[j].y, power);
            y[j].z = ldexpf(y[j].z, power);
        }
        pair_distances(distance, y);
        edml_mds(x, distance, &work);
        TEST_ASSERT_ERROR_UP_TO(ldexpf(MDS_TOLERANCE, power), worst_distance_error(x, distance));
    }
}

/* Also where squares of the matrix's entries are zero in float32. */
static void tiny_distances_give_tiny_points(void)
{
    rng r = rng_seed(31);
    for (int power = -16; power >= -144; power -= 4) {
        for (int n = 0; n < 1000; n++) {
            random_points(&r, y, 1);
            for (int j = 0; j < EDML_JOINTS; j++) {
                if (n % 2) y[j].z = 0;
                if (n % 3 == 0) y[j].y = 0;
                if (n % 5 == 0 && j < 10) y[j] = y[0];
            }
            pair_distances(distance, y);
            for (int k = 0; k < EDML_PAIRS; k++)
                distance[k] = ldexpf(distance[k] + (n % 7 == 0 ? uniform(&r, 0, 0.1F) : 0), power);
            edml_mds(x, distance, &work);
            for (int j = 0; j < EDML_JOINTS; j++)
                TEST_ASSERT_TRUE(hypotf(hypotf(x[j].x, x[j].y), x[j].z) <= ldexpf(16, power));
        }
    }
}
#endif

/* ---- Frame ------------------------------------------------------------------------------------- */

static void the_centroid_is_the_origin_and_the_axes_are_principal(void)
{
    rng r = rng_seed(24);
    for (int n = 0; n < 50; n++) {
        random_human(&r, y);
        check_recovers(y);
        double sum[3] = {0}, m[3][3] = {{0}};
        for (int j = 0; j < EDML_JOINTS; j++) {
            const double p[3] = {(double)x[j].x, (double)x[j].y, (double)x[j].z};
            for (int k = 0; k < 3; k++) {
                sum[k] += p[k];
                for (int l = 0; l < 3; l++) m[k][l] += p[k] * p[l];
            }
        }
        for (int k = 0; k < 3; k++) TEST_ASSERT_ERROR_UP_TO(MDS_CENTROID_TOLERANCE, (float)sum[k]);
        TEST_ASSERT_ERROR_UP_TO(MDS_AXES_TOLERANCE, (float)m[0][1]);
        TEST_ASSERT_ERROR_UP_TO(MDS_AXES_TOLERANCE, (float)m[0][2]);
        TEST_ASSERT_ERROR_UP_TO(MDS_AXES_TOLERANCE, (float)m[1][2]);
        TEST_ASSERT_TRUE(m[0][0] >= m[1][1] && m[1][1] >= m[2][2]);
    }
}

static void turning_moving_and_mirroring_the_person_changes_rounding_only(void)
{
    rng r = rng_seed(25);
    human_pose(y);
    pair_distances(distance, y);
    for (int n = 0; n < 50; n++) {
        edml_point turned[EDML_JOINTS];
        rotate_points(turned, random_rotation(&r), y);
        if (n % 2) reflect(turned, turned);
        for (int j = 0; j < EDML_JOINTS; j++) turned[j].z += 5;
        pair_distances(found, turned);
        edml_mds(x, found, &work);
        TEST_ASSERT_ERROR_UP_TO(MDS_TOLERANCE, worst_distance_error(x, distance));
    }
}

static void what_work_memory_held_does_not_matter(void)
{
    rng r = rng_seed(26);
    random_human(&r, y);
    noisy_distances(&r, distance, y, 0.05F);
    memset(&work, 0, sizeof work);
    edml_mds(x, distance, &work);
    memset(&work, 0xFF, sizeof work);
    edml_mds(y, distance, &work);
    TEST_ASSERT_SAME_BYTES(x, y);
}

/* ---- Beside Jacobi ----------------------------------------------------------------------------- */

/* The same points by all eigenpairs of the whole, doubly centred matrix. */
static void full_mds(edml_point out[EDML_JOINTS], const float d[EDML_PAIRS])
{
    static edml_eigen e;
    double a[EDML_JOINTS][EDML_JOINTS] = {{0}}, mean[EDML_JOINTS] = {0}, all = 0;
    for (int i = 0; i < EDML_JOINTS; i++) {
        for (int j = 0; j < EDML_JOINTS; j++) {
            const double length = i == j ? 0 : (double)d[i < j ? EDML_PAIR(i, j) : EDML_PAIR(j, i)];
            a[i][j] = -length * length / 2;
            mean[i] += a[i][j] / EDML_JOINTS;
            all += a[i][j] / (EDML_JOINTS * EDML_JOINTS);
        }
    }
    edml_matrix gram;
    for (int i = 0; i < EDML_JOINTS; i++)
        for (int j = 0; j < EDML_JOINTS; j++) gram.at[i][j] = (float)(a[i][j] - mean[i] - mean[j] + all);
    edml_jacobi(&e, &gram);
    for (int j = 0; j < EDML_JOINTS; j++) {
        out[j].x = e.value[0] > 0 ? sqrtf(e.value[0]) * e.vector[0][j] : 0;
        out[j].y = e.value[1] > 0 ? sqrtf(e.value[1]) * e.vector[1][j] : 0;
        out[j].z = e.value[2] > 0 ? sqrtf(e.value[2]) * e.vector[2][j] : 0;
    }
}

static double sum_of_squares(const edml_point p[EDML_JOINTS], int axis)
{
    double sum = 0;
    for (int j = 0; j < EDML_JOINTS; j++) {
        const double at = (double)(axis == 0 ? p[j].x : axis == 1 ? p[j].y : p[j].z);
        sum += at * at;
    }
    return sum;
}

/* Worst and mean difference of a distance, over people with noisy distances. */
static float error_beside_jacobi(float noise)
{
    enum { PEOPLE = 400 };
    rng r = rng_seed(27);
    float worst = 0;
    double sum = 0;
    for (int n = 0; n < PEOPLE; n++) {
        random_human(&r, y);
        noisy_distances(&r, distance, y, noise);
        full_mds(y, distance);
        pair_distances(found, y);
        edml_mds(x, distance, &work);
        const float error = worst_distance_error(x, found);
        sum += (double)error / PEOPLE;
        worst = worse(worst, error);
    }
    printf("beside Jacobi, distances with %.0f mm of noise: worst %.4f mm, mean of worst %.4f mm\n",
           1e3 * (double)noise, 1e3 * (double)worst, 1e3 * sum);
    return worst;
}

static void the_points_are_those_of_jacobi(void)
{
    TEST_ASSERT_ERROR_UP_TO(MDS_TOLERANCE, error_beside_jacobi(0));
    TEST_ASSERT_ERROR_UP_TO(MDS_TOLERANCE, error_beside_jacobi(0.01F));
    TEST_ASSERT_ERROR_UP_TO(MDS_TOLERANCE, error_beside_jacobi(0.03F));
    TEST_ASSERT_ERROR_UP_TO(MDS_TOLERANCE, error_beside_jacobi(0.1F));
}

#ifndef EDML_TEST_Q24 /* whose work memory is elsewhere */
/* The fallback gives the same points, so that they do not tell that it was taken.  The matrix does: the fallback leaves
 * next to nothing beside the diagonal, the usual way a reflection w in the first row, w'w = 2. */
static void people_need_no_fallback(void)
{
    rng r = rng_seed(32);
    for (int n = 0; n < 300; n++) {
        random_human(&r, y);
        noisy_distances(&r, distance, y, 0.03F);
        edml_mds(x, distance, &work);
        const float *const w = work.of.points.stage.mds.gram + 1;
        float square = 0;
        for (int i = 0; i < 12; i++) square += w[i] * w[i];
        TEST_ASSERT_FLOAT_WITHIN(1e-5F, 2, square);
    }
}
#endif

/* Orthonormal rows that are orthogonal to (1, ..., 1). */
static void random_axes(rng *r, double axis[EDML_JOINTS - 1][EDML_JOINTS])
{
    for (int k = 0; k < EDML_JOINTS - 1; k++) {
        double square = 0, mean = 0;
        for (int i = 0; i < EDML_JOINTS; i++) mean += (axis[k][i] = (double)gauss(r)) / EDML_JOINTS;
        for (int i = 0; i < EDML_JOINTS; i++) axis[k][i] -= mean;
        for (int l = 0; l < 2 * k; l++) { /* twice */
            double along = 0;
            for (int i = 0; i < EDML_JOINTS; i++) along += axis[k][i] * axis[l % k][i];
            for (int i = 0; i < EDML_JOINTS; i++) axis[k][i] -= along * axis[l % k][i];
        }
        for (int i = 0; i < EDML_JOINTS; i++) square += axis[k][i] * axis[k][i];
        for (int i = 0; i < EDML_JOINTS; i++) axis[k][i] /= sqrt(square);
    }
}

/* Distances of a Gram matrix with these eigenvalues; 0: there are none, because a square is negative. */
static int distances_of(const double eigenvalue[EDML_JOINTS - 1], double axis[][EDML_JOINTS])
{
    int pair = 0;
    for (int i = 0; i < EDML_JOINTS; i++) {
        for (int j = i + 1; j < EDML_JOINTS; j++) {
            double square = 0;
            for (int k = 0; k < EDML_JOINTS - 1; k++)
                square += eigenvalue[k] * (axis[k][i] - axis[k][j]) * (axis[k][i] - axis[k][j]);
            if (square < 0) return 0;
            distance[pair++] = (float)sqrt(square);
        }
    }
    return 1;
}

/* A person who is nearly flat, as networks give them: the third eigenvalue is a thousandth of the first, and
 * the fourth is close. */
static void close_eigenvalues_are_told_apart(void)
{
    const double eigenvalue[EDML_JOINTS - 1] = {5.17,   1.23,   0.0063, 0.0054, 0.0036, 0.0002, 0,
                                                -0.001, -0.003, -0.006, -0.01,  -0.09,  -0.13};
    rng r = rng_seed(29);
    int people = 0;
    for (int n = 0; n < 10000; n++) {
        double axis[EDML_JOINTS - 1][EDML_JOINTS], along = 0;
        random_axes(&r, axis);
        if (!distances_of(eigenvalue, axis)) continue;
        people++;
        edml_mds(x, distance, &work);
        for (int j = 0; j < EDML_JOINTS; j++) along += (double)x[j].z * axis[2][j];
        for (int j = 0; j < EDML_JOINTS; j++) {
            const double wanted = sqrt(eigenvalue[2]) * axis[2][j] * (along < 0 ? -1 : 1);
            TEST_ASSERT_ERROR_UP_TO(MDS_CLOSE_TOLERANCE, x[j].z - (float)wanted);
        }
    }
    TEST_ASSERT_GREATER_THAN(50, people);
}

/* The second eigenvalue and the third nearly coincide.  Then the little that the second sweep leaves between their
 * axes turns them, and how much of it is left after the third sweep matters. */
static void axes_of_near_eigenvalues_are_kept(void)
{
    const double eigenvalue[EDML_JOINTS - 1] = {2.87, 0.3252, 0.3222, 0.0513, 0.0317, 0.012, 0.003,
                                                0,    -0.002, -0.006, -0.013, -0.03,  -0.071};
    rng r = rng_seed(33);
    int people = 0;
    float worst = 0;
    for (int n = 0; n < 10000; n++) {
        double axis[EDML_JOINTS - 1][EDML_JOINTS], along[2] = {0};
        random_axes(&r, axis);
        if (!distances_of(eigenvalue, axis)) continue;
        people++;
        edml_mds(x, distance, &work);
        for (int j = 0; j < EDML_JOINTS; j++) {
            along[0] += (double)x[j].y * axis[1][j];
            along[1] += (double)x[j].z * axis[2][j];
        }
        for (int j = 0; j < EDML_JOINTS; j++) {
            const double wanted = sqrt(eigenvalue[1]) * axis[1][j] * (along[0] < 0 ? -1 : 1);
            const double beside = sqrt(eigenvalue[2]) * axis[2][j] * (along[1] < 0 ? -1 : 1);
            worst = worse(worst, hypotf(x[j].y - (float)wanted, x[j].z - (float)beside));
        }
    }
    printf("second and third eigenvalue near: worst %.4f mm\n", 1e3 * (double)worst);
    TEST_ASSERT_GREATER_THAN(1000, people);
    TEST_ASSERT_ERROR_UP_TO(MDS_NEAR_TOLERANCE, worst);
}

/* How far a sum of squares along an axis is from that of the full decomposition, m^2. */
static float worst_axis_error(void)
{
    float worst = 0;
    full_mds(y, distance);
    edml_mds(x, distance, &work);
    const double found_square[3] = {sum_of_squares(x, 0), sum_of_squares(x, 1), sum_of_squares(x, 2)};
    const double square[3] = {sum_of_squares(y, 0), sum_of_squares(y, 1), sum_of_squares(y, 2)};
    for (int k = 0; k < 3; k++) worst = worse(worst, (float)(found_square[k] - square[k]));
    return worst;
}

/* Joints that coincide: the matrix falls into parts, and not every part has the largest eigenvalues. */
static void joints_in_a_few_places_keep_their_axes(void)
{
    rng r = rng_seed(30);
    for (int n = 0; n < 2000; n++) {
        uint32_t place[EDML_JOINTS];
        for (int j = 0; j < EDML_JOINTS; j++) place[j] = rng_bits(&r) % (2 + (uint32_t)n % 4);
        for (int i = 0, k = 0; i < EDML_JOINTS; i++)
            for (int j = i + 1; j < EDML_JOINTS; j++) distance[k++] = place[i] != place[j];
        TEST_ASSERT_ERROR_UP_TO(MDS_AXES_TOLERANCE, worst_axis_error());
    }
}

static void one_distance_is_kept(void)
{
    for (int k = 0; k < EDML_PAIRS; k++) {
        memset(distance, 0, sizeof distance);
        distance[k] = 3;
        TEST_ASSERT_ERROR_UP_TO(MDS_AXES_TOLERANCE, worst_axis_error());
    }
}

/* Thirteen eigenvalues that nearly coincide. */
static void distances_that_are_nearly_equal_keep_their_axes(void)
{
    rng r = rng_seed(31);
    for (int n = 0; n < 2000; n++) {
        const float noise = powf(10, uniform(&r, -7, -2));
        for (int k = 0; k < EDML_PAIRS; k++) distance[k] = fminf(1.5F + noise * gauss(&r), 3);
        TEST_ASSERT_ERROR_UP_TO(MDS_EQUAL_TOLERANCE, worst_axis_error());
    }
}

/* Nothing like a person: distances drawn at random, the matrix as indefinite as can be. */
static void random_distances_give_finite_points(void)
{
    rng r = rng_seed(28);
    for (int n = 0; n < 300; n++) {
        for (int k = 0; k < EDML_PAIRS; k++) distance[k] = uniform(&r, 0, 4);
        edml_mds(x, distance, &work);
        TEST_ASSERT_TRUE(all_finite(x, 3 * EDML_JOINTS));
    }
}

static void nan_and_infinity_end_in_finite_time(void)
{
    human_pose(y);
    pair_distances(distance, y);
    distance[17] = NAN;
    edml_mds(x, distance, &work);
    distance[17] = INFINITY;
    edml_mds(x, distance, &work);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_person_comes_back);
    RUN_TEST(random_people_come_back);
    RUN_TEST(random_points_come_back);
    RUN_TEST(points_in_a_plane_come_back_flat);
    RUN_TEST(points_on_a_line_come_back_straight);
    RUN_TEST(no_distance_gives_points_at_the_origin);
    RUN_TEST(the_largest_distances_give_finite_points);
#ifndef EDML_TEST_Q24
    RUN_TEST(tiny_people_come_back);
    RUN_TEST(tiny_distances_give_tiny_points);
#endif
    RUN_TEST(the_centroid_is_the_origin_and_the_axes_are_principal);
    RUN_TEST(turning_moving_and_mirroring_the_person_changes_rounding_only);
    RUN_TEST(what_work_memory_held_does_not_matter);
    RUN_TEST(the_points_are_those_of_jacobi);
#ifndef EDML_TEST_Q24
    RUN_TEST(people_need_no_fallback);
#endif
    RUN_TEST(close_eigenvalues_are_told_apart);
    RUN_TEST(axes_of_near_eigenvalues_are_kept);
    RUN_TEST(joints_in_a_few_places_keep_their_axes);
    RUN_TEST(one_distance_is_kept);
    RUN_TEST(distances_that_are_nearly_equal_keep_their_axes);
    RUN_TEST(random_distances_give_finite_points);
    RUN_TEST(nan_and_infinity_end_in_finite_time);
    return UNITY_END();
}
