/* optional/joint_limits.h: bones that point where people's do not, and the mirror image that has fewer.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>

#include "as_float.h"

enum { ALL_BONES = 9, PEOPLE = 500 };

static edml_point person[EDML_JOINTS], x[EDML_JOINTS];
static edml_pose pose, before;

static void pose_of(edml_pose *of, const edml_point joint[EDML_JOINTS])
{
    memset(of, 0, sizeof *of);
    memcpy(of->joint, joint, sizeof of->joint);
    of->misfit = 0.25F;
    of->seen = ALL_SEEN;
}

static int violations_of(const edml_pose *of)
{
    int violations = -1;
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_joint_limits(&violations, of));
    return violations;
}

static int reflect_pose(edml_pose *of)
{
    int fewer = -1;
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_reflect_by_joint_limits(&fewer, of));
    return fewer;
}

static int beyond(const edml_point joint[EDML_JOINTS])
{
    edml_pose of;
    pose_of(&of, joint);
    return violations_of(&of);
}

/* Onto a grid of 2^-10 m, which every format holds exactly. */
static void round_points(edml_point points[EDML_JOINTS])
{
    float *value = &points->x;
    for (int n = 0; n < 3 * EDML_JOINTS; n++) value[n] = floorf(ldexpf(value[n], 10)) / 1024.0F;
}

/* ---- How many bones -------------------------------------------------------------------------------- */

static void a_person_is_human_and_the_mirror_image_is_not(void)
{
    human_pose(person);
    TEST_ASSERT_EQUAL_INT(0, beyond(person));
    reflect(x, person);
    TEST_ASSERT_TRUE(beyond(x) >= 3);
}

/* A joint moved, and with it all that hangs on it. */
static void move(int from, int to, float right, float down, float away)
{
    for (int j = from; j <= to; j++) {
        x[j].x += right;
        x[j].y += down;
        x[j].z += away;
    }
}

static void check_one_beyond(int joint, float right, float down, float away)
{
    memcpy(x, person, sizeof x);
    move(joint, joint, right, down, away);
    TEST_ASSERT_EQUAL_INT_MESSAGE(1, beyond(x), edml_joint_name(joint));
}

/* The person faces the camera: forward is toward -z. */
static void a_joint_bent_the_wrong_way_is_found(void)
{
    human_pose(person);
    check_one_beyond(EDML_R_ANKLE, 0, -0.15F, -0.40F); /* knees bent forward */
    check_one_beyond(EDML_L_ANKLE, 0, -0.15F, -0.45F);
    check_one_beyond(EDML_R_WRIST, -0.05F, 0, 0.50F); /* elbows backward */
    check_one_beyond(EDML_L_WRIST, 0.05F, 0, 0.50F);
    check_one_beyond(EDML_HEAD, 0, 0.25F, 0.30F); /* the head on the back */
    memcpy(x, person, sizeof x);
    move(EDML_R_KNEE, EDML_R_ANKLE, 0, -0.6F, 0.6F); /* a leg backward and up */
    TEST_ASSERT_TRUE(beyond(x) >= 1);
    memcpy(x, person, sizeof x);
    move(EDML_L_ELBOW, EDML_L_WRIST, -0.3F, -0.15F, 0.25F); /* an arm through the back */
    TEST_ASSERT_TRUE(beyond(x) >= 1);
}

/* Rounding moves a bone across the border of a cell now and then. */
static void turning_moving_and_size_do_not_matter(void)
{
    rng r = rng_seed(151);
    int other = 0, some = 0;
    for (int n = 0; n < PEOPLE; n++) {
        random_human(&r, person);
        const float size = uniform(&r, 0.5F, 1.5F);
        rotate_points(x, random_rotation(&r), person);
        for (int j = 0; j < EDML_JOINTS; j++) {
            x[j].x = size * x[j].x + 1;
            x[j].y *= size;
            x[j].z *= size;
        }
        const int found = beyond(person);
        some += found > 0;
        other += found != beyond(x);
    }
    printf("joint limits: %d of %d people beyond, %d counted otherwise when turned\n", some, PEOPLE, other);
    TEST_ASSERT_TRUE(some > PEOPLE / 4 && some < PEOPLE);
    TEST_ASSERT_TRUE(other <= LIMITS_ROTATED);
}

/* Right for left and left for right, seen in a mirror: another person who is as human. */
static void the_person_with_right_and_left_swapped_is_as_human(void)
{
    rng r = rng_seed(152);
    int other = 0;
    for (int n = 0; n < PEOPLE; n++) {
        random_human(&r, person);
        for (int j = 0; j < EDML_JOINTS; j++) {
            x[edml_mirror_joint[j]] = person[j];
            x[edml_mirror_joint[j]].x = -person[j].x;
        }
        other += beyond(person) != beyond(x);
    }
    TEST_ASSERT_TRUE(other <= LIMITS_SWAPPED);
}

static void bones_and_torsos_without_direction_count(void)
{
    human_pose(x);
    x[EDML_R_ANKLE] = x[EDML_R_KNEE];
    TEST_ASSERT_EQUAL_INT(1, beyond(x));
    x[EDML_R_ANKLE] = x[EDML_R_KNEE] = x[EDML_R_HIP];
    TEST_ASSERT_EQUAL_INT(2, beyond(x));
    human_pose(x);
    x[EDML_R_KNEE] = x[EDML_R_HIP]; /* nothing to compare the shin with */
    TEST_ASSERT_EQUAL_INT(2, beyond(x));
    human_pose(x);
    x[EDML_L_HIP] = x[EDML_R_HIP]; /* no pelvis: both legs */
    TEST_ASSERT_EQUAL_INT(4, beyond(x));
    equal_points(x, 0.5F, 0.25F, 1);
    TEST_ASSERT_EQUAL_INT(ALL_BONES, beyond(x));
    equal_points(x, 0, 0, 0);
    for (int j = 0; j < EDML_JOINTS; j++) x[j].y = 0.125F * (float)j;
    TEST_ASSERT_EQUAL_INT(ALL_BONES, beyond(x)); /* on a line */
}

/* ---- The mirror image ------------------------------------------------------------------------------ */

static void a_person_is_left_alone_with_a_margin(void)
{
    human_pose(person);
    round_points(person);
    pose_of(&pose, person);
    before = pose;
    reflect(x, person);
    TEST_ASSERT_EQUAL_INT(beyond(x), reflect_pose(&pose));
    TEST_ASSERT_SAME_BYTES(before, pose);
}

static void the_mirror_image_comes_back_as_the_person(void)
{
    human_pose(person);
    round_points(person);
    reflect(x, person);
    pose_of(&pose, x);
    TEST_ASSERT_EQUAL_INT(beyond(x), reflect_pose(&pose));
    TEST_ASSERT_ERROR_UP_TO(0, worst_joint_error(person, pose.joint));
    TEST_ASSERT_TRUE(pose.misfit == 0.25F && pose.seen == ALL_SEEN);
}

static void any_mirror_image_comes_back_as_the_person_turned(void)
{
    rng r = rng_seed(153);
    human_pose(person);
    for (int n = 0; n < 50; n++) {
        reflect(x, person);
        rotate_points(x, random_rotation(&r), x);
        pose_of(&pose, x);
        TEST_ASSERT_TRUE(reflect_pose(&pose) >= 3);
        TEST_ASSERT_TRUE(same_handedness(pose.joint, person));
        TEST_ASSERT_EQUAL_INT(0, violations_of(&pose));
    }
}

static void the_choice_is_never_the_worse_one_and_a_second_run_agrees(void)
{
    rng r = rng_seed(154);
    int undecided = 0;
    for (int n = 0; n < PEOPLE; n++) {
        if (n % 2)
            random_points(&r, x, 1);
        else
            random_human(&r, x);
        round_points(x);
        pose_of(&pose, x);
        before = pose;
        const int given = violations_of(&pose), fewer = reflect_pose(&pose);
        const int turned = memcmp(&pose, &before, sizeof pose) != 0;
        TEST_ASSERT_TRUE(fewer >= 0 && fewer <= ALL_BONES && (fewer > 0 || !turned));
        TEST_ASSERT_EQUAL_INT(turned ? given - fewer : given, violations_of(&pose));
        before = pose;
        TEST_ASSERT_EQUAL_INT(fewer, reflect_pose(&pose));
        TEST_ASSERT_SAME_BYTES(before, pose);
        undecided += fewer == 0;
    }
    TEST_ASSERT_TRUE(undecided > 0 && undecided < PEOPLE / 2);
}

/* ---- What is no pose --------------------------------------------------------------------------------- */

static void check_no_pose(void)
{
    before = pose;
    int count = 77;
    TEST_ASSERT_EQUAL_INT(EDML_ERR_NOT_FINITE, edml_joint_limits(&count, &pose));
    TEST_ASSERT_EQUAL_INT(EDML_ERR_NOT_FINITE, edml_reflect_by_joint_limits(&count, &pose));
    TEST_ASSERT_EQUAL_INT(77, count);
    TEST_ASSERT_SAME_BYTES(before, pose);
}

static void what_is_no_pose_is_refused_and_stays(void)
{
    const float bad[] = {NAN, INFINITY, -INFINITY, 4, -4, 1e30F};
    human_pose(person);
    for (int n = 0; n < 6 * 3 * EDML_JOINTS; n++) {
        pose_of(&pose, person);
        (&pose.joint[0].x)[n / 6] = bad[n % 6];
        check_no_pose();
    }
}

#ifndef EDML_TEST_Q24
static void fixed_point_counts_the_same(void)
{
    rng r = rng_seed(155);
    int other = 0;
    for (int n = 0; n < 4 * PEOPLE; n++) {
        edml_pose_q given;
        if (n % 2)
            random_points(&r, x, 1);
        else
            random_human(&r, x);
        round_points(x);
        pose_of(&pose, x);
        pose_to_q16(&given, &pose);
        int count = -1;
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_joint_limits_q(&count, &given));
        other += violations_of(&pose) != count;
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_reflect_by_joint_limits_q(&count, &given));
        other += reflect_pose(&pose) != count;
    }
    printf("joint limits: %d of %d counts are others in fixed point\n", other, 8 * PEOPLE);
    TEST_ASSERT_TRUE(other <= LIMITS_FIXED);
}
#endif

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_person_is_human_and_the_mirror_image_is_not);
    RUN_TEST(a_joint_bent_the_wrong_way_is_found);
    RUN_TEST(turning_moving_and_size_do_not_matter);
    RUN_TEST(the_person_with_right_and_left_swapped_is_as_human);
    RUN_TEST(bones_and_torsos_without_direction_count);
    RUN_TEST(a_person_is_left_alone_with_a_margin);
    RUN_TEST(the_mirror_image_comes_back_as_the_person);
    RUN_TEST(any_mirror_image_comes_back_as_the_person_turned);
    RUN_TEST(the_choice_is_never_the_worse_one_and_a_second_run_agrees);
    RUN_TEST(what_is_no_pose_is_refused_and_stays);
#ifndef EDML_TEST_Q24
    RUN_TEST(fixed_point_counts_the_same);
#endif
    return UNITY_END();
}
