/* lift/refine.h: downhill, never uphill; in fixed point never out of range, and where float32 goes.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>
#include <stdlib.h>

#include "native.h"

static const edml_objective objectives[] = {EDML_STRESS_SQUARE, EDML_STRESS_RAW, EDML_STRESS_EQ2};
enum { OBJECTIVES = 3, STEPS = 10 };

static edml_work work;
static point x[EDML_JOINTS], y[EDML_JOINTS], start[EDML_JOINTS];
static real distance[EDML_PAIRS];
static point_f32 person[EDML_JOINTS];
static float wanted[EDML_PAIRS]; /* the same as distance */

/* Also rounds what float32 is given. */
static void use_distances(void)
{
    for (int n = 0; n < EDML_PAIRS; n++) {
        distance[n] = to_real(wanted[n] < REFINE_FARTHEST ? wanted[n] : REFINE_FARTHEST);
        wanted[n] = from_real(distance[n]);
    }
}

static void use_start(void) { to_points(start, person); }

/* A person, with noisy distances. */
static void a_person(rng *r, float noise)
{
    random_human(r, person);
    noisy_distances(r, wanted, person, noise);
    use_distances();
}

/* The same, and the points of the MDS. */
static void start_from_a_person(rng *r, float noise)
{
    a_person(r, noise);
    edml_mds(start, distance, &work);
}

static void a_standing_person(void)
{
    human_pose(person);
    pair_distances(wanted, person);
    use_distances();
}

static int refined(point p[EDML_JOINTS], edml_objective objective, int steps)
{
    memcpy(p, start, sizeof start);
    return edml_refine(p, distance, objective, steps, &work);
}

/* ---- The objective ----------------------------------------------------------------------------- */

static double stress(const point p[EDML_JOINTS], edml_objective objective)
{
    point_f32 at[EDML_JOINTS];
    double sum = 0;
    from_points(at, p);
    for (int i = 0; i < EDML_JOINTS; i++) {
        for (int j = i + 1; j < EDML_JOINTS; j++) {
            const double d = distance_between(at[i], at[j]), want = (double)wanted[EDML_PAIR(i, j)];
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
        a_person(&r, 0.1F);
        to_points(x, person);
        for (int k = 0; k < OBJECTIVES; k++) {
            const float expected = (float)stress(x, objectives[k]);
            const float actual = from_real(edml_stress(x, distance, objectives[k]));
            TEST_ASSERT_FLOAT_WITHIN(STRESS_TOLERANCE(expected), expected, actual);
        }
    }
}

static void stress_of_nothing_is_zero(void)
{
    random_points(&(rng){1}, person, 1);
    to_points(x, person);
    TEST_ASSERT_TRUE(edml_stress(x, distance, EDML_STRESS_NONE) == 0);
}

static void stress_of_equal_points_is_the_mean_of_the_distances_alone(void)
{
    a_standing_person();
    equal_points(person, 1, 2, 3);
    to_points(x, person);
    for (int k = 0; k < OBJECTIVES; k++) {
        const float expected = (float)stress(x, objectives[k]);
        TEST_ASSERT_FLOAT_WITHIN(STRESS_TOLERANCE(expected), expected,
                                 from_real(edml_stress(x, distance, objectives[k])));
    }
}

/* ---- Never uphill, never out of range ------------------------------------------------------------ */

static float largest_coordinate(const point p[EDML_JOINTS])
{
    float largest = 0;
    for (int j = 0; j < EDML_JOINTS; j++) {
        largest = worse(largest, fabsf(from_real(p[j].x)));
        largest = worse(largest, fabsf(from_real(p[j].y)));
        largest = worse(largest, fabsf(from_real(p[j].z)));
    }
    return largest;
}

/* From `start`, for every objective and number of steps: no more steps than asked for, finite points, none
 * farther away than is allowed, and an objective that fell or, where no step was taken, points that have not
 * moved. */
static void check_downhill(void)
{
    for (int k = 0; k < OBJECTIVES; k++) {
        const edml_objective objective = objectives[k];
        real before = edml_stress(start, distance, objective);
        for (int steps = 0; steps <= 20; steps = steps < 4 ? steps + 1 : steps + 8) {
            const int taken = refined(x, objective, steps);
            const real after = edml_stress(x, distance, objective);
            TEST_ASSERT_TRUE(taken >= 0 && taken <= steps);
            TEST_ASSERT_TRUE(after <= before); /* more steps, no more stress */
            if (taken == 0)
                TEST_ASSERT_SAME_BYTES(start, x);
            else
                TEST_ASSERT_TRUE(largest_coordinate(x) < REFINE_REACH);
            before = after;
        }
    }
}

static void the_objective_never_rises_near_the_solution(void)
{
    rng r = rng_seed(32);
    for (int n = 0; n < 60; n++) {
        start_from_a_person(&r, 0.03F);
        check_downhill();
    }
}

static void the_objective_never_rises_with_any_noise(void)
{
    rng r = rng_seed(132);
    for (int n = 0; n < 120; n++) {
        start_from_a_person(&r, 0.06F * (float)(n % 6)); /* 0 to 300 mm */
        check_downhill();
    }
}

static void the_objective_never_rises_from_a_bad_start(void)
{
    rng r = rng_seed(33);
    for (int n = 0; n < 60; n++) {
        a_person(&r, 0.05F);
        random_points(&r, person, n % 2 ? REFINE_BAD_START : 0.01F);
        use_start();
        check_downhill();
    }
}

static void the_objective_never_rises_from_a_line_or_a_plane(void)
{
    a_standing_person();
    for (int j = 0; j < EDML_JOINTS; j++) person[j].z = 0;
    use_start();
    check_downhill();
    for (int j = 0; j < EDML_JOINTS; j++) person[j].x = 0;
    use_start();
    check_downhill();
}

/* Distances of nothing: any, small ones, the smallest or the largest, tiny ones. */
static void the_objective_never_rises_for_impossible_distances(void)
{
    rng r = rng_seed(34);
    for (int n = 0; n < 160; n++) {
        for (int k = 0; k < EDML_PAIRS; k++) {
            const float any = uniform(&r, 0, REFINE_FARTHEST);
            wanted[k] = n % 4 == 0   ? any
                        : n % 4 == 1 ? any / 400
                        : n % 4 == 2 ? REFINE_FARTHEST * (any < REFINE_FARTHEST / 2)
                                     : any / 30000;
        }
        use_distances();
        edml_mds(start, distance, &work);
        check_downhill();
        random_points(&r, person, 1);
        use_start();
        check_downhill();
    }
}

/* Two heaps, all distances across them 3 m: the MDS puts points as far apart as it ever does where those
 * within the heaps are as wrong as can be. */
static void the_objective_never_rises_for_heaps(void)
{
    for (int heap = 1; heap <= EDML_JOINTS / 2; heap++) {
        for (int i = 0; i < EDML_JOINTS; i++)
            for (int j = i + 1; j < EDML_JOINTS; j++)
                wanted[EDML_PAIR(i, j)] = (i < heap) != (j < heap) ? 3.0F : (float)((i * j) % 3);
        use_distances();
        edml_mds(start, distance, &work);
        check_downhill();
    }
}

/* It comes nearer in steps of MAX_STEP. */
static void the_objective_never_rises_from_a_joint_far_away(void)
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        a_standing_person();
        person[j].x += 5;
        use_start();
        check_downhill();
    }
}

static void distances_of_zero_draw_the_points_together(void)
{
    memset(distance, 0, sizeof distance);
    human_pose(person);
    use_start();
    check_downhill();
    const real before = edml_stress(start, distance, EDML_STRESS_RAW);
    refined(x, EDML_STRESS_RAW, STEPS);
    TEST_ASSERT_TRUE(edml_stress(x, distance, EDML_STRESS_RAW) < before / 100);
}

/* Nothing says in which direction to part them. */
static void equal_points_stay_where_they_are(void)
{
    a_standing_person();
    equal_points(person, 0.5F, -0.25F, 1);
    use_start();
    check_downhill();
    for (int k = 0; k < OBJECTIVES; k++) {
        TEST_ASSERT_EQUAL_INT(0, refined(x, objectives[k], STEPS));
        TEST_ASSERT_SAME_BYTES(start, x);
    }
}

static void the_right_points_stay_nearly_where_they_are(void)
{
    a_standing_person();
    use_start();
    check_downhill();
    for (int k = 0; k < OBJECTIVES; k++) {
        point_f32 at[EDML_JOINTS];
        refined(x, objectives[k], STEPS);
        from_points(at, x);
        TEST_ASSERT_ERROR_UP_TO(REFINE_STAY_TOLERANCE, worst_joint_error(at, person));
    }
}

/* ---- Downhill far enough ------------------------------------------------------------------------- */

static void exact_distances_come_back_from_disturbed_points(void)
{
    rng r = rng_seed(35);
    float worst[OBJECTIVES] = {0};
    for (int n = 0; n < 100; n++) {
        a_person(&r, 0);
        for (int j = 0; j < EDML_JOINTS; j++) {
            person[j].x += 0.02F * gauss(&r);
            person[j].y += 0.02F * gauss(&r);
            person[j].z += 0.02F * gauss(&r);
        }
        use_start();
        for (int k = 0; k < OBJECTIVES; k++) {
            point_f32 at[EDML_JOINTS];
            refined(x, objectives[k], 60);
            from_points(at, x);
            worst[k] = worse(worst[k], worst_distance_error(at, wanted));
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
    TEST_ASSERT_EQUAL_INT(0, edml_refine(x, distance, EDML_STRESS_NONE, STEPS, &work));
    TEST_ASSERT_EQUAL_INT(0, edml_refine(x, distance, EDML_STRESS_SQUARE, 0, &work));
    TEST_ASSERT_EQUAL_INT(0, edml_refine(x, distance, EDML_STRESS_EQ2, -1, &work));
    TEST_ASSERT_SAME_BYTES(start, x);
    memset(distance, 0, sizeof distance);
    TEST_ASSERT_EQUAL_INT(0, edml_refine(x, distance, EDML_STRESS_NONE, STEPS, &work));
    TEST_ASSERT_SAME_BYTES(start, x);
}

static void rotated_points_are_refined_to_rotated_points(void)
{
    rng r = rng_seed(36);
    for (int n = 0; n < 30; n++) {
        start_from_a_person(&r, 0.02F);
        const rotation3 turn = random_rotation(&r);
        for (int k = 0; k < OBJECTIVES; k++) {
            point_f32 first[EDML_JOINTS], second[EDML_JOINTS];
            from_points(person, start);
            rotate_points(person, turn, person);
            to_points(x, person);
            edml_refine(x, distance, objectives[k], 4, &work);
            from_points(first, x);
            refined(y, objectives[k], 4);
            from_points(second, y);
            rotate_points(second, turn, second);
            TEST_ASSERT_ERROR_UP_TO(REFINE_ROTATED_TOLERANCE, worst_joint_error(first, second));
        }
    }
}

static void reflect_native(point p[EDML_JOINTS])
{
    for (int j = 0; j < EDML_JOINTS; j++) p[j].z = -p[j].z;
}

/* In float bit for bit; fixed point rounds halves up, on either side of zero. */
static void reflected_points_are_refined_to_reflected_points(void)
{
    rng r = rng_seed(37);
    start_from_a_person(&r, 0.05F);
    for (int k = 0; k < OBJECTIVES; k++) {
        point_f32 first[EDML_JOINTS], second[EDML_JOINTS];
        refined(x, objectives[k], STEPS);
        memcpy(y, start, sizeof y);
        reflect_native(y);
        edml_refine(y, distance, objectives[k], STEPS, &work);
        reflect_native(y);
        from_points(first, x);
        from_points(second, y);
        TEST_ASSERT_ERROR_UP_TO(REFINE_REFLECTED_TOLERANCE, worst_joint_error(first, second));
    }
}

static void what_work_memory_held_does_not_matter(void)
{
    rng r = rng_seed(38);
    for (int n = 0; n < 2; n++) {
        start_from_a_person(&r, 0.05F);
        if (n == 1) use_start();
        for (int k = 0; k < OBJECTIVES; k++) {
            static const int fills[] = {0xFF, 0x7F};
            memset(&work, 0, sizeof work);
            refined(x, objectives[k], STEPS);
            for (int f = 0; f < 2; f++) {
                memset(&work, fills[f], sizeof work);
                refined(y, objectives[k], STEPS);
                TEST_ASSERT_SAME_BYTES(x, y);
            }
        }
    }
}

#ifndef EDML_TEST_Q24

static void nan_takes_no_step(void)
{
    a_standing_person();
    use_start();
    distance[40] = NAN;
    for (int k = 0; k < OBJECTIVES; k++) {
        TEST_ASSERT_EQUAL_INT(0, refined(x, objectives[k], STEPS));
        TEST_ASSERT_SAME_BYTES(start, x);
    }
}

#else /* ---- Fixed point: its range, and float32 beside it ---- */

enum { ONE = 1 << 24 };

static void stress_is_that_of_float(void)
{
    rng r = rng_seed(131);
    float worst = 0;
    for (int n = 0; n < 50; n++) {
        a_person(&r, 0.1F);
        to_points(x, person);
        from_points(person, x);
        for (int k = 0; k < OBJECTIVES; k++) {
            const float expected = stress_f32(person, wanted, objectives[k]);
            const float actual = from_real(edml_stress(x, distance, objectives[k]));
            worst = worse(worst, fabsf(actual - expected));
        }
    }
    printf("stress in Q24 against float32, worst: %.3g\n", (double)worst);
    TEST_ASSERT_ERROR_UP_TO(STRESS_Q24_TOLERANCE, worst);
}

static void stress_of_points_far_apart_is_the_largest_there_is(void)
{
    memset(distance, 0, sizeof distance);
    memset(x, 0, sizeof x);
    for (int k = 0; k < OBJECTIVES; k++) {
        x[3].y = 8 * ONE - 1;
        TEST_ASSERT_TRUE(edml_stress(x, distance, objectives[k]) > 0);
        for (x[3].y = 8 * ONE; x[3].y < 64 * ONE; x[3].y += ONE)
            TEST_ASSERT_EQUAL_INT32(64 * ONE, edml_stress(x, distance, objectives[k]));
    }
    for (int j = 0; j < EDML_JOINTS; j++) x[j].y = j % 2 ? 8 * ONE - 1 : 0; /* mean of 49 * 64^2 */
    TEST_ASSERT_EQUAL_INT32(64 * ONE, edml_stress(x, distance, EDML_STRESS_SQUARE));
}

static void points_far_apart_stay_where_they_are(void)
{
    rng r = rng_seed(135);
    for (int n = 0; n < 30; n++) {
        a_person(&r, 0.03F);
        random_points(&r, person, 1);
        person[n % EDML_JOINTS].x = n % 2 ? 63.0F : -9.5F;
        use_start();
        for (int k = 0; k < OBJECTIVES; k++) {
            TEST_ASSERT_EQUAL_INT(0, refined(x, objectives[k], STEPS));
            TEST_ASSERT_SAME_BYTES(start, x);
        }
    }
}

/* Distances of which one step of raw stress made points of 129 m^2, beyond what orient adds up. */
static void refined_points_are_those_of_orient(void)
{
    static const struct {
        int pair;
        int32_t distance;
    } others[] = {{0, 50326528},  {1, 49807360},  {2, 50200576},  {21, 50310656}, {27, 48234496},
                  {29, 41943040}, {35, 50069504}, {36, 50329600}, {38, 50282496}, {41, 48234496},
                  {59, 33554432}, {77, 49905664}, {81, 46137344}};
    edml_image image = {.seen = (1U << EDML_JOINTS) - 1};
    for (int n = 0; n < EDML_PAIRS; n++) distance[n] = 3 * ONE;
    for (size_t n = 0; n < sizeof others / sizeof *others; n++)
        distance[others[n].pair] = others[n].distance;
    edml_mds(start, distance, &work);
    for (int k = 0; k < OBJECTIVES; k++) {
        const int taken = refined(x, objectives[k], STEPS);
        double squares = 0;
        for (int j = 0; j < EDML_JOINTS; j++) {
            const double at[] = {from_real(x[j].x), from_real(x[j].y), from_real(x[j].z)};
            squares += at[0] * at[0] + at[1] * at[1] + at[2] * at[2];
            image.at[j].u = x[j].x / 4;
            image.at[j].v = x[j].y / 8;
        }
        TEST_ASSERT_TRUE(squares < 32 || taken == 0);
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_orient(x, &image));
    }
}

/* People, their distances off by 30 mm: how far from float32's the points are at worst, and how much worse
 * the objective is. */
static void compare(edml_objective objective, const char *name)
{
    enum { PEOPLE = 500, FEW = 5 };
    static work_f32 float_work;
    static point_f32 at[EDML_JOINTS];
    rng r = rng_seed(136);
    float worst = 0, worst_rise = 0;
    for (int n = 0; n < PEOPLE; n++) {
        start_from_a_person(&r, 0.03F);
        from_points(person, start);
        refine_f32(person, wanted, objective, FEW, &float_work);
        refined(x, objective, FEW);
        from_points(at, x);
        const float expected = stress_f32(person, wanted, objective);
        const float reached = stress_f32(at, wanted, objective);
        worst = worse(worst, worst_joint_error(at, person));
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

#endif

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(stress_is_the_mean_over_the_pairs);
    RUN_TEST(stress_of_nothing_is_zero);
    RUN_TEST(stress_of_equal_points_is_the_mean_of_the_distances_alone);
    RUN_TEST(the_objective_never_rises_near_the_solution);
    RUN_TEST(the_objective_never_rises_with_any_noise);
    RUN_TEST(the_objective_never_rises_from_a_bad_start);
    RUN_TEST(the_objective_never_rises_from_a_line_or_a_plane);
    RUN_TEST(the_objective_never_rises_for_impossible_distances);
    RUN_TEST(the_objective_never_rises_for_heaps);
    RUN_TEST(the_objective_never_rises_from_a_joint_far_away);
    RUN_TEST(distances_of_zero_draw_the_points_together);
    RUN_TEST(equal_points_stay_where_they_are);
    RUN_TEST(the_right_points_stay_nearly_where_they_are);
    RUN_TEST(exact_distances_come_back_from_disturbed_points);
    RUN_TEST(nothing_is_done_where_nothing_is_asked);
    RUN_TEST(rotated_points_are_refined_to_rotated_points);
    RUN_TEST(reflected_points_are_refined_to_reflected_points);
    RUN_TEST(what_work_memory_held_does_not_matter);
#ifndef EDML_TEST_Q24
    RUN_TEST(nan_takes_no_step);
#else
    RUN_TEST(stress_is_that_of_float);
    RUN_TEST(stress_of_points_far_apart_is_the_largest_there_is);
    RUN_TEST(points_far_apart_stay_where_they_are);
    RUN_TEST(refined_points_are_those_of_orient);
    RUN_TEST(s_stress_is_refined_as_by_float);
    RUN_TEST(raw_stress_is_refined_as_by_float);
    RUN_TEST(eq2_is_refined_as_by_float);
#endif
    return UNITY_END();
}
