/* lift/refine.h in fixed point: downhill, never uphill, never out of range, and where float32 goes.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>
#include <stdlib.h>

#include "helpers.h"

static const edml_objective objectives[] = {EDML_STRESS_SQUARE, EDML_STRESS_RAW, EDML_STRESS_EQ2};
enum { OBJECTIVES = 3, STEPS = 10, ONE = 1 << 24 };

static edml_work_q work;
static edml_point_q24 x[EDML_JOINTS], y[EDML_JOINTS], start[EDML_JOINTS];
static int32_t distance[EDML_PAIRS];
static edml_point person[EDML_JOINTS];
static float distance_f32[EDML_PAIRS];

static int32_t to_q24(float a) { return (int32_t)lrint((double)a * ONE); }

static void points_to_q24(edml_point_q24 to[EDML_JOINTS], const edml_point from[EDML_JOINTS])
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        to[j].x = to_q24(from[j].x);
        to[j].y = to_q24(from[j].y);
        to[j].z = to_q24(from[j].z);
    }
}

static void points_to_f32(edml_point to[EDML_JOINTS], const edml_point_q24 from[EDML_JOINTS])
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        to[j].x = (float)from[j].x / ONE;
        to[j].y = (float)from[j].y / ONE;
        to[j].z = (float)from[j].z / ONE;
    }
}

/* To [0, 3] m, also what float32 is given. */
static void distances_to_q24(void)
{
    for (int n = 0; n < EDML_PAIRS; n++) {
        distance[n] = to_q24(distance_f32[n] < 3.0F ? distance_f32[n] : 3.0F);
        distance_f32[n] = (float)distance[n] / ONE;
    }
}

/* A person, with noisy distances and the points of the MDS. */
static void start_from_a_person(rng *r, float noise)
{
    random_human(r, person);
    noisy_distances(r, distance_f32, person, noise);
    distances_to_q24();
    edml_mds_q(start, distance, &work);
}

/* ---- The objective ----------------------------------------------------------------------------- */

static void stress_is_that_of_float(void)
{
    rng r = rng_seed(131);
    float worst = 0;
    for (int n = 0; n < 50; n++) {
        random_human(&r, person);
        noisy_distances(&r, distance_f32, person, 0.1F);
        distances_to_q24();
        points_to_q24(x, person);
        points_to_f32(person, x);
        for (int k = 0; k < OBJECTIVES; k++) {
            const float expected = edml_stress(person, distance_f32, objectives[k]);
            const float actual = (float)edml_stress_q(x, distance, objectives[k]) / ONE;
            worst = worse(worst, fabsf(actual - expected));
        }
    }
    printf("stress in Q24 against float32, worst: %.3g\n", (double)worst);
    TEST_ASSERT_ERROR_UP_TO(STRESS_Q24_TOLERANCE, worst);
}

static void stress_of_nothing_is_zero(void)
{
    TEST_ASSERT_EQUAL_INT32(0, edml_stress_q(x, distance, EDML_STRESS_NONE));
}

static void stress_of_points_far_apart_is_the_largest_there_is(void)
{
    memset(distance, 0, sizeof distance);
    memset(x, 0, sizeof x);
    for (int k = 0; k < OBJECTIVES; k++) {
        x[3].y = 8 * ONE - 1;
        TEST_ASSERT_TRUE(edml_stress_q(x, distance, objectives[k]) > 0);
        for (x[3].y = 8 * ONE; x[3].y < 64 * ONE; x[3].y += ONE)
            TEST_ASSERT_EQUAL_INT32(64 * ONE, edml_stress_q(x, distance, objectives[k]));
    }
    for (int j = 0; j < EDML_JOINTS; j++) x[j].y = j % 2 ? 8 * ONE - 1 : 0; /* mean of 49 * 64^2 */
    TEST_ASSERT_EQUAL_INT32(64 * ONE, edml_stress_q(x, distance, EDML_STRESS_SQUARE));
}

/* ---- Never uphill, never out of range ------------------------------------------------------------ */

static int64_t largest_coordinate(const edml_point_q24 p[EDML_JOINTS])
{
    int64_t largest = 0;
    for (int j = 0; j < EDML_JOINTS; j++) {
        const int64_t at[] = {p[j].x, p[j].y, p[j].z};
        for (int k = 0; k < 3; k++)
            if (llabs(at[k]) > largest) largest = llabs(at[k]);
    }
    return largest;
}

/* From `start`, for every objective and number of steps: no more steps than asked for, an objective
 * that fell or, where no step was taken, points that have not moved; none further away than 8 m. */
static void check_downhill(void)
{
    for (int k = 0; k < OBJECTIVES; k++) {
        const edml_objective objective = objectives[k];
        int32_t before = edml_stress_q(start, distance, objective);
        for (int steps = 0; steps <= 20; steps = steps < 4 ? steps + 1 : steps + 8) {
            memcpy(x, start, sizeof x);
            const int taken = edml_refine_q(x, distance, objective, steps, &work);
            const int32_t after = edml_stress_q(x, distance, objective);
            TEST_ASSERT_TRUE(taken >= 0 && taken <= steps);
            TEST_ASSERT_TRUE(after <= before); /* more steps, no more stress */
            if (taken == 0)
                TEST_ASSERT_SAME_BYTES(start, x);
            else
                TEST_ASSERT_TRUE(largest_coordinate(x) < 8 * ONE);
            before = after;
        }
    }
}

static void the_objective_never_rises_of_people(void)
{
    rng r = rng_seed(132);
    for (int n = 0; n < 120; n++) {
        start_from_a_person(&r, 0.06F * (float)(n % 6)); /* 0 to 300 mm */
        check_downhill();
    }
}

static void the_objective_never_rises_from_a_bad_start(void)
{
    rng r = rng_seed(133);
    for (int n = 0; n < 60; n++) {
        start_from_a_person(&r, 0.05F);
        random_points(&r, person, n % 2 ? 2.3F : 0.01F);
        points_to_q24(start, person);
        check_downhill();
    }
}

/* Distances of nothing: any, the smallest or the largest, tiny ones. */
static void the_objective_never_rises_for_impossible_distances(void)
{
    rng r = rng_seed(134);
    for (int n = 0; n < 120; n++) {
        for (int k = 0; k < EDML_PAIRS; k++) {
            const float any = uniform(&r, 0, 3);
            distance_f32[k] = n % 3 == 0 ? any : n % 3 == 1 ? 3.0F * (any < 1.5F) : any / 30000;
        }
        distances_to_q24();
        edml_mds_q(start, distance, &work);
        check_downhill();
        random_points(&r, person, 1);
        points_to_q24(start, person);
        check_downhill();
    }
}

/* Two heaps, all distances across them 3 m: the MDS puts points as far apart as it ever does where
 * those within the heaps are as wrong as can be. */
static void the_objective_never_rises_for_heaps(void)
{
    for (int heap = 1; heap <= EDML_JOINTS / 2; heap++) {
        for (int i = 0; i < EDML_JOINTS; i++)
            for (int j = i + 1; j < EDML_JOINTS; j++)
                distance[EDML_PAIR(i, j)] = (i < heap) != (j < heap) ? 3 * ONE : (i * j) % 3 * ONE;
        edml_mds_q(start, distance, &work);
        check_downhill();
    }
}

static void distances_of_zero_draw_the_points_together(void)
{
    memset(distance, 0, sizeof distance);
    human_pose(person);
    points_to_q24(start, person);
    check_downhill();
    const int32_t before = edml_stress_q(start, distance, EDML_STRESS_RAW);
    memcpy(x, start, sizeof x);
    edml_refine_q(x, distance, EDML_STRESS_RAW, STEPS, &work);
    TEST_ASSERT_TRUE(edml_stress_q(x, distance, EDML_STRESS_RAW) < before / 100);
}

static void equal_points_stay_where_they_are(void)
{
    human_pose(person);
    pair_distances(distance_f32, person);
    distances_to_q24();
    equal_points(person, 0.5F, -0.25F, 1);
    points_to_q24(start, person);
    check_downhill();
    for (int k = 0; k < OBJECTIVES; k++) {
        memcpy(x, start, sizeof x);
        TEST_ASSERT_EQUAL_INT(0, edml_refine_q(x, distance, objectives[k], STEPS, &work));
    }
}

static void points_far_apart_stay_where_they_are(void)
{
    rng r = rng_seed(135);
    for (int n = 0; n < 30; n++) {
        start_from_a_person(&r, 0.03F);
        random_points(&r, person, 1);
        person[n % EDML_JOINTS].x = n % 2 ? 63.0F : -9.5F;
        points_to_q24(start, person);
        for (int k = 0; k < OBJECTIVES; k++) {
            memcpy(x, start, sizeof x);
            TEST_ASSERT_EQUAL_INT(0, edml_refine_q(x, distance, objectives[k], STEPS, &work));
            TEST_ASSERT_SAME_BYTES(start, x);
        }
    }
}

/* ---- As far as float32 -------------------------------------------------------------------------- */

/* People, their distances off by 30 mm: how far from float32's the points are at worst, and how much
 * worse the objective is. */
static void compare(edml_objective objective, const char *name)
{
    enum { PEOPLE = 500, FEW = 5 };
    static edml_work work_f32;
    static edml_point refined[EDML_JOINTS];
    rng r = rng_seed(136);
    float worst = 0, worst_rise = 0;
    for (int n = 0; n < PEOPLE; n++) {
        start_from_a_person(&r, 0.03F);
        points_to_f32(person, start);
        memcpy(x, start, sizeof x);
        edml_refine(person, distance_f32, objective, FEW, &work_f32);
        edml_refine_q(x, distance, objective, FEW, &work);
        points_to_f32(refined, x);
        const float expected = edml_stress(person, distance_f32, objective);
        const float reached = edml_stress(refined, distance_f32, objective);
        worst = worse(worst, worst_joint_error(refined, person));
        worst_rise = worse(worst_rise, reached / expected - 1.0F);
    }
    printf("refined in Q24, of %d people: %s at worst %.4f mm off, the objective %.4f %% higher\n", PEOPLE,
           name, 1e3 * (double)worst, 1e2 * (double)worst_rise);
    TEST_ASSERT_ERROR_UP_TO(REFINE_Q24_TOLERANCE, worst);
    TEST_ASSERT_TRUE(worst_rise <= REFINE_Q24_RISE);
}

static void s_stress_is_refined_as_by_float(void) { compare(EDML_STRESS_SQUARE, "s-stress"); }

static void raw_stress_is_refined_as_by_float(void) { compare(EDML_STRESS_RAW, "raw stress"); }

static void eq2_is_refined_as_by_float(void) { compare(EDML_STRESS_EQ2, "eq. 2"); }

static void exact_distances_come_back_from_disturbed_points(void)
{
    rng r = rng_seed(137);
    float worst[OBJECTIVES] = {0};
    for (int n = 0; n < 100; n++) {
        start_from_a_person(&r, 0);
        for (int j = 0; j < EDML_JOINTS; j++) {
            person[j].x += 0.02F * gauss(&r);
            person[j].y += 0.02F * gauss(&r);
            person[j].z += 0.02F * gauss(&r);
        }
        for (int k = 0; k < OBJECTIVES; k++) {
            edml_point refined[EDML_JOINTS];
            points_to_q24(x, person);
            edml_refine_q(x, distance, objectives[k], 60, &work);
            points_to_f32(refined, x);
            worst[k] = worse(worst[k], worst_distance_error(refined, distance_f32));
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
    rng r = rng_seed(138);
    start_from_a_person(&r, 0.1F);
    memcpy(x, start, sizeof x);
    TEST_ASSERT_EQUAL_INT(0, edml_refine_q(x, distance, EDML_STRESS_NONE, STEPS, &work));
    TEST_ASSERT_EQUAL_INT(0, edml_refine_q(x, distance, EDML_STRESS_SQUARE, 0, &work));
    TEST_ASSERT_EQUAL_INT(0, edml_refine_q(x, distance, EDML_STRESS_EQ2, -1, &work));
    TEST_ASSERT_SAME_BYTES(start, x);
}

static void what_work_memory_held_does_not_matter(void)
{
    rng r = rng_seed(139);
    start_from_a_person(&r, 0.05F);
    for (int k = 0; k < OBJECTIVES; k++) {
        memset(&work, 0, sizeof work);
        memcpy(x, start, sizeof x);
        edml_refine_q(x, distance, objectives[k], STEPS, &work);
        memset(&work, 0x7F, sizeof work);
        memcpy(y, start, sizeof y);
        edml_refine_q(y, distance, objectives[k], STEPS, &work);
        TEST_ASSERT_SAME_BYTES(x, y);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(stress_is_that_of_float);
    RUN_TEST(stress_of_nothing_is_zero);
    RUN_TEST(stress_of_points_far_apart_is_the_largest_there_is);
    RUN_TEST(the_objective_never_rises_of_people);
    RUN_TEST(the_objective_never_rises_from_a_bad_start);
    RUN_TEST(the_objective_never_rises_for_impossible_distances);
    RUN_TEST(the_objective_never_rises_for_heaps);
    RUN_TEST(distances_of_zero_draw_the_points_together);
    RUN_TEST(equal_points_stay_where_they_are);
    RUN_TEST(points_far_apart_stay_where_they_are);
    RUN_TEST(s_stress_is_refined_as_by_float);
    RUN_TEST(raw_stress_is_refined_as_by_float);
    RUN_TEST(eq2_is_refined_as_by_float);
    RUN_TEST(exact_distances_come_back_from_disturbed_points);
    RUN_TEST(nothing_is_done_where_nothing_is_asked);
    RUN_TEST(what_work_memory_held_does_not_matter);
    return UNITY_END();
}
