/* lift/refine.h: downhill, never uphill.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>

#include "helpers.h"

static const edml_objective objectives[] = {EDML_STRESS_SQUARE, EDML_STRESS_RAW, EDML_STRESS_EQ2};
enum { OBJECTIVES = 3, STEPS = 10 };

static edml_work work;
static edml_point x[EDML_JOINTS], y[EDML_JOINTS], start[EDML_JOINTS];
static float distance[EDML_PAIRS];

/* ---- The objective ----------------------------------------------------------------------------- */

static double stress(const edml_point p[EDML_JOINTS], edml_objective objective)
{
    double sum = 0;
    for (int i = 0; i < EDML_JOINTS; i++) {
        for (int j = i + 1; j < EDML_JOINTS; j++) {
            const double d = distance_between(p[i], p[j]), want = (double)distance[EDML_PAIR(i, j)];
            const double excess = d * d - want * want;
            sum += objective == EDML_STRESS_SQUARE ? excess * excess
                   : objective == EDML_STRESS_RAW  ? (d - want) * (d - want)
                                                   : fabs(excess);
        }
    }
    return sum / EDML_PAIRS;
}

static void stress_is_the_mean_over_the_pairs(void)
{
    rng r = rng_seed(31);
    for (int n = 0; n < 50; n++) {
        random_human(&r, x);
        noisy_distances(&r, distance, x, 0.1F);
        for (int k = 0; k < OBJECTIVES; k++) {
            const double expected = stress(x, objectives[k]);
            const float actual = edml_stress(x, distance, objectives[k]);
            TEST_ASSERT_FLOAT_WITHIN(STRESS_TOLERANCE * (float)expected, (float)expected, actual);
        }
    }
}

static void stress_of_nothing_is_zero(void)
{
    random_points(&(rng){1}, x, 1);
    TEST_ASSERT_TRUE(edml_stress(x, distance, EDML_STRESS_NONE) == 0);
}

static void stress_of_equal_points_is_the_mean_of_the_distances_alone(void)
{
    human_pose(y);
    pair_distances(distance, y);
    equal_points(x, 1, 2, 3);
    for (int k = 0; k < OBJECTIVES; k++) {
        const float expected = (float)stress(x, objectives[k]);
        TEST_ASSERT_FLOAT_WITHIN(STRESS_TOLERANCE * expected, expected,
                                 edml_stress(x, distance, objectives[k]));
    }
}

/* ---- Never uphill ------------------------------------------------------------------------------ */

/* From `start`, for every objective and number of steps: no more steps than asked for, finite
 * points, and an objective that fell or, where no step was taken, points that have not moved. */
static void check_downhill(void)
{
    for (int k = 0; k < OBJECTIVES; k++) {
        const edml_objective objective = objectives[k];
        float before = edml_stress(start, distance, objective);
        for (int steps = 0; steps <= 20; steps = steps < 4 ? steps + 1 : steps + 8) {
            memcpy(x, start, sizeof x);
            const int taken = edml_refine(x, distance, objective, steps, &work);
            const float after = edml_stress(x, distance, objective);
            TEST_ASSERT_TRUE(taken >= 0 && taken <= steps);
            TEST_ASSERT_TRUE(all_finite(x, 3 * EDML_JOINTS));
            TEST_ASSERT_TRUE(after <= before); /* more steps, no more stress */
            if (taken == 0) TEST_ASSERT_SAME_BYTES(start, x);
            before = after;
        }
    }
}

static void the_objective_never_rises_near_the_solution(void)
{
    rng r = rng_seed(32);
    for (int n = 0; n < 60; n++) {
        random_human(&r, y);
        noisy_distances(&r, distance, y, 0.03F);
        edml_mds(start, distance, &work);
        check_downhill();
    }
}

static void the_objective_never_rises_from_a_bad_start(void)
{
    rng r = rng_seed(33);
    for (int n = 0; n < 60; n++) {
        random_human(&r, y);
        noisy_distances(&r, distance, y, 0.05F);
        random_points(&r, start, n % 2 ? 4.0F : 0.01F);
        check_downhill();
    }
}

static void the_objective_never_rises_from_a_line_or_a_plane(void)
{
    human_pose(y);
    pair_distances(distance, y);
    human_pose(start);
    for (int j = 0; j < EDML_JOINTS; j++) start[j].z = 0;
    check_downhill();
    for (int j = 0; j < EDML_JOINTS; j++) start[j].x = 0;
    check_downhill();
}

static void the_objective_never_rises_for_impossible_distances(void)
{
    rng r = rng_seed(34);
    for (int n = 0; n < 60; n++) {
        for (int k = 0; k < EDML_PAIRS; k++) distance[k] = uniform(&r, 0, n % 2 ? 4.0F : 0.01F);
        random_points(&r, start, 1);
        check_downhill();
    }
}

static void distances_of_zero_draw_the_points_together(void)
{
    memset(distance, 0, sizeof distance);
    human_pose(start);
    check_downhill();
    const float before = edml_stress(start, distance, EDML_STRESS_RAW);
    memcpy(x, start, sizeof x);
    edml_refine(x, distance, EDML_STRESS_RAW, STEPS, &work);
    TEST_ASSERT_TRUE(edml_stress(x, distance, EDML_STRESS_RAW) < before / 100);
}

/* Nothing says in which direction to part them. */
static void equal_points_stay_where_they_are(void)
{
    human_pose(y);
    pair_distances(distance, y);
    equal_points(start, 0.5F, -0.25F, 1);
    check_downhill();
    memcpy(x, start, sizeof x);
    TEST_ASSERT_EQUAL_INT(0, edml_refine(x, distance, EDML_STRESS_RAW, STEPS, &work));
    TEST_ASSERT_SAME_BYTES(start, x);
}

static void the_right_points_stay_nearly_where_they_are(void)
{
    human_pose(start);
    pair_distances(distance, start);
    check_downhill();
    for (int k = 0; k < OBJECTIVES; k++) {
        memcpy(x, start, sizeof x);
        edml_refine(x, distance, objectives[k], STEPS, &work);
        TEST_ASSERT_ERROR_UP_TO(REFINE_STAY_TOLERANCE, worst_joint_error(x, start));
    }
}

/* ---- Downhill far enough ------------------------------------------------------------------------- */

static void exact_distances_come_back_from_disturbed_points(void)
{
    rng r = rng_seed(35);
    float worst[OBJECTIVES] = {0};
    for (int n = 0; n < 100; n++) {
        random_human(&r, y);
        pair_distances(distance, y);
        for (int j = 0; j < EDML_JOINTS; j++) {
            start[j].x = y[j].x + 0.02F * gauss(&r);
            start[j].y = y[j].y + 0.02F * gauss(&r);
            start[j].z = y[j].z + 0.02F * gauss(&r);
        }
        for (int k = 0; k < OBJECTIVES; k++) {
            memcpy(x, start, sizeof x);
            edml_refine(x, distance, objectives[k], 60, &work);
            const float error = worst_distance_error(x, distance);
            worst[k] = worse(worst[k], error);
        }
    }
    printf("refinement of exact distances, worst mm: square %.4f, raw %.4f, eq2 %.4f\n",
           1e3 * (double)worst[0], 1e3 * (double)worst[1], 1e3 * (double)worst[2]);
    TEST_ASSERT_ERROR_UP_TO(REFINE_SQUARE_TOLERANCE, worst[0]);
    TEST_ASSERT_ERROR_UP_TO(REFINE_RAW_TOLERANCE, worst[1]);
    TEST_ASSERT_ERROR_UP_TO(REFINE_EQ2_TOLERANCE, worst[2]);
}

/* ---- What does not matter ------------------------------------------------------------------------ */

static void nothing_is_done_where_nothing_is_asked(void)
{
    human_pose(start);
    memset(distance, 0, sizeof distance);
    memcpy(x, start, sizeof x);
    TEST_ASSERT_EQUAL_INT(0, edml_refine(x, distance, EDML_STRESS_NONE, STEPS, &work));
    TEST_ASSERT_EQUAL_INT(0, edml_refine(x, distance, EDML_STRESS_SQUARE, 0, &work));
    TEST_ASSERT_EQUAL_INT(0, edml_refine(x, distance, EDML_STRESS_EQ2, -1, &work));
    TEST_ASSERT_SAME_BYTES(start, x);
}

static void turned_points_are_refined_to_turned_points(void)
{
    rng r = rng_seed(36);
    for (int n = 0; n < 30; n++) {
        random_human(&r, y);
        noisy_distances(&r, distance, y, 0.02F);
        edml_mds(start, distance, &work);
        const rotation3 turn = random_rotation(&r);
        for (int k = 0; k < OBJECTIVES; k++) {
            rotate_points(x, turn, start);
            edml_refine(x, distance, objectives[k], 4, &work);
            memcpy(y, start, sizeof y);
            edml_refine(y, distance, objectives[k], 4, &work);
            rotate_points(y, turn, y);
            TEST_ASSERT_ERROR_UP_TO(REFINE_TURNED_TOLERANCE, worst_joint_error(x, y));
        }
    }
}

static void mirrored_points_are_refined_to_mirrored_points_bit_for_bit(void)
{
    rng r = rng_seed(37);
    random_human(&r, y);
    noisy_distances(&r, distance, y, 0.05F);
    edml_mds(start, distance, &work);
    for (int k = 0; k < OBJECTIVES; k++) {
        memcpy(x, start, sizeof x);
        edml_refine(x, distance, objectives[k], STEPS, &work);
        reflect(y, start);
        edml_refine(y, distance, objectives[k], STEPS, &work);
        reflect(y, y);
        TEST_ASSERT_SAME_BYTES(x, y);
    }
}

static void what_work_memory_held_does_not_matter(void)
{
    rng r = rng_seed(38);
    random_human(&r, start);
    noisy_distances(&r, distance, start, 0.05F);
    for (int k = 0; k < OBJECTIVES; k++) {
        memset(&work, 0, sizeof work);
        memcpy(x, start, sizeof x);
        edml_refine(x, distance, objectives[k], STEPS, &work);
        memset(&work, 0xFF, sizeof work);
        memcpy(y, start, sizeof y);
        edml_refine(y, distance, objectives[k], STEPS, &work);
        TEST_ASSERT_SAME_BYTES(x, y);
    }
}

static void nan_takes_no_step(void)
{
    human_pose(start);
    pair_distances(distance, start);
    distance[40] = NAN;
    for (int k = 0; k < OBJECTIVES; k++) {
        memcpy(x, start, sizeof x);
        TEST_ASSERT_EQUAL_INT(0, edml_refine(x, distance, objectives[k], STEPS, &work));
        TEST_ASSERT_SAME_BYTES(start, x);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(stress_is_the_mean_over_the_pairs);
    RUN_TEST(stress_of_nothing_is_zero);
    RUN_TEST(stress_of_equal_points_is_the_mean_of_the_distances_alone);
    RUN_TEST(the_objective_never_rises_near_the_solution);
    RUN_TEST(the_objective_never_rises_from_a_bad_start);
    RUN_TEST(the_objective_never_rises_from_a_line_or_a_plane);
    RUN_TEST(the_objective_never_rises_for_impossible_distances);
    RUN_TEST(distances_of_zero_draw_the_points_together);
    RUN_TEST(equal_points_stay_where_they_are);
    RUN_TEST(the_right_points_stay_nearly_where_they_are);
    RUN_TEST(exact_distances_come_back_from_disturbed_points);
    RUN_TEST(nothing_is_done_where_nothing_is_asked);
    RUN_TEST(turned_points_are_refined_to_turned_points);
    RUN_TEST(mirrored_points_are_refined_to_mirrored_points_bit_for_bit);
    RUN_TEST(what_work_memory_held_does_not_matter);
    RUN_TEST(nan_takes_no_step);
    return UNITY_END();
}
