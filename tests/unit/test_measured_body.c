/* optional/measure_body: the bones of a person, from many poses.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>

#include "as_float.h"

static edml_measured_body measured;
static edml_pose pose;

static void someone(rng *r)
{
    memset(&pose, 0, sizeof pose);
    random_human(r, pose.joint);
    rotate_points(pose.joint, random_rotation(r), pose.joint);
    root_at_mid_hip(pose.joint);
    pose.seen = ALL_SEEN;
}

static float length_of(int bone)
{
    return (float)distance_between(pose.joint[edml_bones[bone].from], pose.joint[edml_bones[bone].to]);
}

static void scale_pose(float by)
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        pose.joint[j].x *= by;
        pose.joint[j].y *= by;
        pose.joint[j].z *= by;
    }
}

/* Moves a joint, so that the bones beside it change. */
static void disturb(rng *r, float by)
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        pose.joint[j].x += by * gauss(r);
        pose.joint[j].y += by * gauss(r);
        pose.joint[j].z += by * gauss(r);
    }
}

static void measure(void) { TEST_ASSERT_EQUAL_INT(EDML_OK, edml_measure_body(&measured, &pose)); }

/* The pose has the bones that were measured so far, and right and left are alike. */
static void check_fit(void)
{
    edml_pose fitted = pose;
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_fit_body(&fitted, &measured.body));
    pose = fitted;
    for (int n = 0; n < EDML_BONES; n++)
        TEST_ASSERT_FLOAT_WITHIN(2e-4F, measured.body.bone[n], length_of(n));
    for (int n = 1; n < EDML_BONES; n++) {
        const int other = n >= 10 ? n - 3 : n >= 7 ? n + 3 : n >= 4 ? n - 3 : n + 3;
        TEST_ASSERT_TRUE(measured.body.bone[n] == measured.body.bone[other]);
    }
}

static void from_the_first_pose_on_there_is_a_body(void)
{
    rng r = rng_seed(211);
    for (int n = 0; n < 200; n++) {
        edml_measure_start(&measured);
        for (int k = 0; k < 5; k++) {
            someone(&r);
            scale_pose(0.8F + 0.002F * (float)n);
            disturb(&r, 0.03F);
            measure();
            check_fit();
            TEST_ASSERT_EQUAL_INT(k + 1, measured.poses);
            TEST_ASSERT_TRUE(measured.body.height == 0);
        }
    }
}

/* Joints are off by 2 cm, and in one pose of eight by 20. */
static void many_bad_poses_measure_one_good_body(void)
{
    rng r = rng_seed(212);
    float truth[EDML_BONES], single = 0, worst = 0;
    someone(&r);
    for (int n = 0; n < EDML_BONES; n++) truth[n] = length_of(n);
    edml_measure_start(&measured);
    for (int k = 0; k < EDML_MEASURED_POSES; k++) {
        someone(&r);
        disturb(&r, k % 8 == 5 ? 0.2F : 0.02F);
        for (int n = 0; n < EDML_BONES; n++) single = worse(single, fabsf(length_of(n) / truth[n] - 1));
        (void)edml_measure_body(&measured, &pose);
    }
    for (int n = 0; n < EDML_BONES; n++) worst = worse(worst, fabsf(measured.body.bone[n] / truth[n] - 1));
    printf("measured body: the worst bone of a pose is off by %.0f %%, of all poses by %.1f %%\n",
           (double)(100 * single), (double)(100 * worst));
    TEST_ASSERT_TRUE(single > 0.5F);
    TEST_ASSERT_TRUE(worst < 0.08F);
}

static void after_many_poses_the_bones_are_held(void)
{
    rng r = rng_seed(213);
    edml_measure_start(&measured);
    for (int k = 0; k < EDML_MEASURED_POSES; k++) {
        someone(&r);
        measure();
    }
    const edml_measured_body before = measured;
    someone(&r);
    scale_pose(1.2F);
    measure();
    TEST_ASSERT_SAME_BYTES(before, measured);
}

static void bones_that_are_not_seen_are_not_measured(void)
{
    rng r = rng_seed(214);
    edml_measure_start(&measured);
    someone(&r);
    pose.seen = ALL_SEEN & ~(1U << EDML_L_KNEE | 1U << EDML_R_KNEE);
    measure();
    const edml_body first = measured.body;
    for (int k = 0; k < 20; k++) {
        edml_pose usual;
        someone(&r);
        pose.seen = ALL_SEEN & ~(1U << EDML_L_KNEE | 1U << EDML_R_KNEE);
        usual = pose;
        pose.joint[EDML_L_KNEE].z += 0.2F; /* imputed somewhere */
        measure();
        pose = usual;
    }
    for (int bone = 8; bone <= 12; bone++) {
        if (bone == 10) continue;
        TEST_ASSERT_EQUAL_INT(0, measured.seen[bone]);
        TEST_ASSERT_TRUE(measured.body.bone[bone] == first.bone[bone]);
    }
    TEST_ASSERT_EQUAL_INT(21, measured.seen[2]);
    TEST_ASSERT_TRUE(measured.body.bone[2] != first.bone[2]);
    pose.seen = ALL_SEEN & ~(1U << EDML_L_KNEE); /* the right one will do */
    measure();
    TEST_ASSERT_EQUAL_INT(1, measured.seen[8]);
    TEST_ASSERT_EQUAL_INT(1, measured.seen[11]);
}

/* Whatever the poses are, the body is one that edml_fit_body() takes. */
static void the_body_is_always_a_persons(void)
{
    rng r = rng_seed(215);
    int measures = 0;
    for (int n = 0; n < 300; n++) {
        edml_measure_start(&measured);
        for (int k = 0; k < EDML_MEASURED_POSES; k++) {
            someone(&r);
            if (n % 3 == 0) random_points(&r, pose.joint, uniform(&r, 0.1F, 1));
            if (n % 3 == 1) pose.joint[n % EDML_JOINTS].y += 1.5F;
            scale_pose(uniform(&r, 0.3F, 1.4F));
            const edml_status status = edml_measure_body(&measured, &pose);
            TEST_ASSERT_TRUE(status == EDML_OK || status == EDML_ERR_DEGENERATE);
            measures += status == EDML_OK;
        }
        someone(&r);
        const edml_status status = edml_fit_body(&pose, &measured.body);
        TEST_ASSERT_EQUAL_STRING("ok", edml_status_name(status));
    }
    TEST_ASSERT_TRUE(measures > 5000);
}

static void expect(edml_status status)
{
    const edml_measured_body before = measured;
    TEST_ASSERT_EQUAL_INT(status, edml_measure_body(&measured, &pose));
    TEST_ASSERT_SAME_BYTES(before, measured);
}

static void what_is_nobody_is_not_measured(void)
{
    rng r = rng_seed(216);
    edml_measure_start(&measured);
    someone(&r);
    measure();
    scale_pose(0.2F);
    expect(EDML_ERR_DEGENERATE);
    scale_pose(8);
    expect(EDML_ERR_DEGENERATE);
    memset(pose.joint, 0, sizeof pose.joint);
    expect(EDML_ERR_DEGENERATE);
    someone(&r);
    pose.joint[3].x = 4.1F;
    expect(EDML_ERR_NOT_FINITE);
    pose.joint[3].x = NAN;
    expect(EDML_ERR_NOT_FINITE);
    TEST_ASSERT_EQUAL_INT(EDML_ERR_ARGUMENT, edml_measure_body(NULL, &pose));
    TEST_ASSERT_EQUAL_INT(EDML_ERR_ARGUMENT, edml_measure_body(&measured, NULL));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(from_the_first_pose_on_there_is_a_body);
    RUN_TEST(many_bad_poses_measure_one_good_body);
    RUN_TEST(after_many_poses_the_bones_are_held);
    RUN_TEST(bones_that_are_not_seen_are_not_measured);
    RUN_TEST(the_body_is_always_a_persons);
    RUN_TEST(what_is_nobody_is_not_measured);
    return UNITY_END();
}
