/* optional/many.h: the same poses, statuses and joints as one by one.
 *
 * SPDX-License-Identifier: MIT
 */
#include "native.h"

enum { PEOPLE = 24 };

static edml_work work;
static edml_keypoint in[PEOPLE][EDML_JOINTS];
static edml_point up[PEOPLE];
static edml_pose poses[PEOPLE], one;
static edml_status status[PEOPLE];
static const edml_camera camera = {PIXELS(1145), PIXELS(1145), PIXELS(500), PIXELS(500)};

/* Every fifth is not to be lifted, and every seventh has no up. */
static void make_people(void)
{
    for (int n = 0; n < PEOPLE; n++) {
        rng r = rng_seed((uint32_t)n);
        point_f32 x[EDML_JOINTS];
        keypoint_f32 image[EDML_JOINTS];
        random_human(&r, x);
        photograph(image, x);
        for (int j = 0; j < EDML_JOINTS && n % 5 == 4; j++) image[j].c = j < 4;
        to_keypoints(in[n], image);
        const point_f32 above = {0, n % 7 == 6 ? 0 : -1, 0.1F * (float)(n % 3)};
        up[n] = to_api_point(above);
    }
}

static edml_status lift_one(int n, const edml_point *above, const edml_camera *by)
{
    if (by == NULL) return edml_lift(&one, in[n], above, &DISTANCES, &work, sizeof work);
    return edml_lift_with_camera(&one, in[n], above, by, &DISTANCES, &work, sizeof work);
}

static int lift_many(int count, const edml_point *above, const edml_camera *by)
{
    return edml_lift_many(poses, status, in[0], above, by, count, &DISTANCES, &work, sizeof work);
}

static void check_many(const edml_point *above, const edml_camera *by)
{
    memset(poses, 0x5A, sizeof poses);
    const int count = lift_many(PEOPLE, above, by);
    int lifted = 0;
    for (int n = 0; n < PEOPLE; n++) {
        memset(&one, 0x5A, sizeof one);
        TEST_ASSERT_EQUAL_INT(lift_one(n, above == NULL ? NULL : &above[n], by), status[n]);
        TEST_ASSERT_SAME_BYTES(one.joint, poses[n].joint);
        TEST_ASSERT_SAME_BYTES(one.misfit, poses[n].misfit);
        TEST_ASSERT_EQUAL_UINT16(one.seen, poses[n].seen);
        lifted += status[n] == EDML_OK;
    }
    TEST_ASSERT_EQUAL_INT(lifted, count);
    TEST_ASSERT_GREATER_THAN(PEOPLE / 2, lifted);
    TEST_ASSERT_LESS_THAN(PEOPLE, lifted);
}

static void each_is_as_one_by_one(void)
{
    make_people();
    check_many(NULL, NULL);
    check_many(up, NULL);
    check_many(NULL, &camera);
    check_many(up, &camera);
}

static void nobody_is_no_error(void)
{
    make_people();
    TEST_ASSERT_EQUAL_INT(0, lift_many(0, NULL, NULL));
}

static void missing_arrays_are_refused_and_nothing_is_written(void)
{
    const size_t bytes = sizeof work;
    edml_status before[PEOPLE];
    make_people();
    memset(status, 0x5A, sizeof status);
    memcpy(before, status, sizeof status);
    TEST_ASSERT_EQUAL_INT(-1, edml_lift_many(NULL, status, in[0], NULL, NULL, 1, &DISTANCES, &work, bytes));
    TEST_ASSERT_EQUAL_INT(-1, edml_lift_many(poses, NULL, in[0], NULL, NULL, 1, &DISTANCES, &work, bytes));
    TEST_ASSERT_EQUAL_INT(-1, edml_lift_many(poses, status, NULL, NULL, NULL, 1, &DISTANCES, &work, bytes));
    TEST_ASSERT_EQUAL_INT(-1, lift_many(-1, NULL, NULL));
    TEST_ASSERT_SAME_BYTES(before, status);
}

static void a_missing_model_is_the_status_of_each(void)
{
    make_people();
    TEST_ASSERT_EQUAL_INT(0, edml_lift_many(poses, status, in[0], NULL, NULL, 3, NULL, &work, sizeof work));
    for (int n = 0; n < 3; n++) TEST_ASSERT_EQUAL_INT(EDML_ERR_ARGUMENT, status[n]);
}

static void check_joints(const edml_keypoint wanted[EDML_JOINTS], const edml_keypoint found[EDML_JOINTS])
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        TEST_ASSERT_SAME_BYTES(wanted[j].x, found[j].x);
        TEST_ASSERT_SAME_BYTES(wanted[j].y, found[j].y);
        TEST_ASSERT_SAME_BYTES(wanted[j].c, found[j].c);
    }
}

static void each_is_adapted_as_one_by_one(void)
{
    enum { KEYPOINTS = 17 };
    static edml_keypoint given[PEOPLE][KEYPOINTS], joints[PEOPLE + 1][EDML_JOINTS], before[EDML_JOINTS];
    make_people();
    for (int n = 0; n < PEOPLE; n++) /* the last keypoints of a person are another's first */
        for (int k = 0; k < KEYPOINTS; k++) given[n][k] = in[(n + k / EDML_JOINTS) % PEOPLE][k % EDML_JOINTS];
    memset(joints, 0x5A, sizeof joints);
    memset(before, 0x5A, sizeof before);
    edml_adapt_many(joints[0], given[0], -1, &edml_coco17);
    TEST_ASSERT_SAME_BYTES(before, joints[0]);
    edml_adapt_many(joints[0], given[0], PEOPLE, &edml_coco17);
    TEST_ASSERT_SAME_BYTES(before, joints[PEOPLE]);
    for (int n = 0; n < PEOPLE; n++) {
        edml_keypoint alone[EDML_JOINTS];
        edml_adapt(alone, given[n], &edml_coco17);
        check_joints(alone, joints[n]);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(each_is_as_one_by_one);
    RUN_TEST(nobody_is_no_error);
    RUN_TEST(missing_arrays_are_refused_and_nothing_is_written);
    RUN_TEST(a_missing_model_is_the_status_of_each);
    RUN_TEST(each_is_adapted_as_one_by_one);
    return UNITY_END();
}
