/* lift/mirror.h: the pose, not its mirror image.  What is tested holds for any sensible weights.
 *
 * SPDX-License-Identifier: MIT
 */
#include "as_float.h"

static edml_point person[EDML_JOINTS], x[EDML_JOINTS], y[EDML_JOINTS];

static float run(edml_point points[EDML_JOINTS]) { return edml_mirror(points, &edml_fconn_f32); }

/* Onto a grid of 2^-20 m, which every format holds exactly. */
static void round_points(edml_point points[EDML_JOINTS])
{
    float *value = &points->x;
    for (int n = 0; n < 3 * EDML_JOINTS; n++) value[n] = floorf(ldexpf(value[n], 20)) / 1048576.0F;
}

static void a_person_is_left_alone_with_a_margin(void)
{
    human_pose(person);
    round_points(person);
    memcpy(x, person, sizeof x);
    TEST_ASSERT_TRUE(run(x) > 1);
    TEST_ASSERT_SAME_BYTES(person, x);
}

static void the_mirror_image_comes_back_as_the_person(void)
{
    human_pose(person);
    round_points(person);
    memcpy(x, person, sizeof x);
    const float margin = run(x);
    reflect(y, person);
    TEST_ASSERT_TRUE(run(y) == margin);
    TEST_ASSERT_SAME_BYTES(person, y);
}

/* Mirrored in a plane other than z = 0, the person comes back turned. */
static void any_mirror_image_comes_back_as_the_person_turned(void)
{
    rng r = rng_seed(41);
    float distance[EDML_PAIRS];
    human_pose(person);
    round_points(person);
    pair_distances(distance, person);
    memcpy(x, person, sizeof x);
    const float margin = run(x);
    for (int n = 0; n < 50; n++) {
        reflect(y, person);
        rotate_points(y, random_rotation(&r), y);
        TEST_ASSERT_FLOAT_WITHIN(MARGIN_TOLERANCE, margin, run(y));
        TEST_ASSERT_ERROR_UP_TO(ROUNDING, worst_distance_error(y, distance));
        TEST_ASSERT_TRUE(same_handedness(y, person));
    }
}

static void turning_and_moving_changes_neither_choice_nor_margin(void)
{
    rng r = rng_seed(42);
    for (int n = 0; n < 100; n++) {
        random_human(&r, person);
        memcpy(x, person, sizeof x);
        const float margin = run(x);
        if (margin < 0.01F) continue; /* rounding may decide */
        rotate_points(y, random_rotation(&r), x);
        for (int j = 0; j < EDML_JOINTS; j++) y[j].x += 1;
        memcpy(person, y, sizeof person);
        TEST_ASSERT_FLOAT_WITHIN(MARGIN_TOLERANCE, margin, run(y));
        TEST_ASSERT_ERROR_UP_TO(ROUNDING, worst_joint_error(person, y));
    }
}

#ifndef EDML_TEST_Q24 /* whose rounding is absolute */
static void scaling_by_a_power_of_two_keeps_the_margin_bit_for_bit(void)
{
    human_pose(x);
    round_points(x);
    const float margin = run(x);
    for (int j = 0; j < EDML_JOINTS; j++) {
        y[j].x = x[j].x / 8;
        y[j].y = x[j].y / 8;
        y[j].z = x[j].z / 8;
    }
    TEST_ASSERT_TRUE(run(y) == margin);
}
#endif

/* Right for left and left for right, seen in a mirror: another person who is as human. */
static void the_person_with_right_and_left_swapped_scores_the_same(void)
{
    rng r = rng_seed(43);
    for (int n = 0; n < 50; n++) {
        random_human(&r, person);
        memcpy(x, person, sizeof x);
        for (int j = 0; j < EDML_JOINTS; j++) {
            y[edml_mirror_joint[j]] = x[j];
            y[edml_mirror_joint[j]].x = -x[j].x;
        }
        TEST_ASSERT_FLOAT_WITHIN(MARGIN_TOLERANCE, run(x), run(y));
    }
}

static void the_margin_is_never_negative_and_a_second_run_agrees(void)
{
    rng r = rng_seed(44);
    for (int n = 0; n < 100; n++) {
        random_points(&r, x, 1);
        round_points(x);
        const float margin = run(x);
        memcpy(y, x, sizeof y);
        TEST_ASSERT_TRUE(margin >= 0);
        TEST_ASSERT_TRUE(run(y) == margin);
        TEST_ASSERT_SAME_BYTES(x, y);
    }
}

static void equal_points_have_no_margin(void)
{
    equal_points(x, 0, 0, 0);
    TEST_ASSERT_TRUE(run(x) == 0);
    equal_points(x, 0.5F, 0.25F, 1);
    TEST_ASSERT_TRUE(run(x) == 0);
    TEST_ASSERT_TRUE(all_finite(x, 3 * EDML_JOINTS));
}

static void a_flat_person_has_no_margin(void)
{
    human_pose(x);
    round_points(x);
    for (int j = 0; j < EDML_JOINTS; j++) x[j].z = 0;
    TEST_ASSERT_TRUE(run(x) == 0);
}

static void a_bone_without_length_does_not_count(void)
{
    human_pose(x);
    round_points(x);
    x[EDML_R_WRIST] = x[EDML_R_ELBOW];
    x[EDML_L_HIP] = x[EDML_R_HIP] = x[EDML_NECK_BASE]; /* neither chest nor pelvis */
    TEST_ASSERT_TRUE(run(x) == 0);
    TEST_ASSERT_TRUE(all_finite(x, 3 * EDML_JOINTS));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_person_is_left_alone_with_a_margin);
    RUN_TEST(the_mirror_image_comes_back_as_the_person);
    RUN_TEST(any_mirror_image_comes_back_as_the_person_turned);
    RUN_TEST(turning_and_moving_changes_neither_choice_nor_margin);
#ifndef EDML_TEST_Q24
    RUN_TEST(scaling_by_a_power_of_two_keeps_the_margin_bit_for_bit);
#endif
    RUN_TEST(the_person_with_right_and_left_swapped_scores_the_same);
    RUN_TEST(the_margin_is_never_negative_and_a_second_run_agrees);
    RUN_TEST(equal_points_have_no_margin);
    RUN_TEST(a_flat_person_has_no_margin);
    RUN_TEST(a_bone_without_length_does_not_count);
    return UNITY_END();
}
