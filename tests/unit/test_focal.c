/* optional/camera/focal: one focal length, from many poses.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>

#include "as_float.h"

static edml_work work;
static edml_focal focal;
static edml_camera camera;
static edml_pose pose;
static edml_keypoint in[EDML_JOINTS];

/* Someone at a distance in metres, whom a camera of this focal length and 1000 by 800 pixels sees; the joints of
 * the pose are off by so many. */
static void someone(rng *r, float focal_length, float away, float off)
{
    edml_point x[EDML_JOINTS];
    memset(&pose, 0, sizeof pose);
    random_human(r, x);
    root_at_mid_hip(x);
    memcpy(pose.joint, x, sizeof x);
    for (int j = 0; j < EDML_JOINTS; j++) {
        in[j].x = 500 + focal_length * x[j].x / (x[j].z + away);
        in[j].y = 400 + focal_length * x[j].y / (x[j].z + away);
        in[j].c = 1;
        pose.joint[j].x += off * gauss(r);
        pose.joint[j].y += off * gauss(r);
        pose.joint[j].z += off * gauss(r);
    }
}

static void add(void)
{
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_focal_add(&focal, &pose, in, &work, sizeof work));
}

static float found(void)
{
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_focal_camera(&camera, &focal));
    TEST_ASSERT_TRUE(camera.fx == camera.fy && camera.cx == 500 && camera.cy == 400);
    TEST_ASSERT_TRUE(camera.fx >= 400 && camera.fx <= 3200); /* 0.5 to 4 heights */
    return camera.fx;
}

static void near_people_in_exact_poses_show_it(void)
{
    rng r = rng_seed(221);
    for (int n = 0; n < 6; n++) {
        const float truth = 800 * 0.7F * powf(3, (float)n / 5);
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_focal_start(&focal, 1000, 800));
        for (int k = 0; k < 10; k++) {
            someone(&r, truth, 1.7F, 0);
            add();
        }
        TEST_ASSERT_EQUAL_INT(10, focal.poses);
        TEST_ASSERT_FLOAT_WITHIN(0.2F, 0, logf(found() / truth));
    }
}

/* Far away, people look the same through all focal lengths: then it is a usual camera's. */
static void people_who_say_nothing_have_a_usual_camera(void)
{
    rng r = rng_seed(222);
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_focal_start(&focal, 1000, 800));
    for (int k = 0; k < 10; k++) {
        someone(&r, 800, 40, 0);
        add();
    }
    TEST_ASSERT_FLOAT_WITHIN(0.1F, 0, logf(found() / (1.2F * 800)));
}

/* With poses as bad as lifted ones, one at a time would give a dozen focal lengths. */
static void many_poses_give_one_that_hardly_moves(void)
{
    rng r = rng_seed(223);
    float spread = 0, least = INFINITY, most = 0;
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_focal_start(&focal, 1000, 800));
    for (int k = 0; k < 60; k++) {
        edml_placement placement;
        someone(&r, 960, 3.5F, 0.03F);
        TEST_ASSERT_EQUAL_INT(
            EDML_OK, edml_place_sweep(&placement, &camera, &pose, in, 1000, 800, &work, sizeof work));
        if (camera.fx < least) least = camera.fx;
        if (camera.fx > most) most = camera.fx;
        add();
        spread = k >= 10 ? worse(spread, fabsf(found() / 960 - 1)) : 0;
    }
    printf("focal length of 960: each alone %.0f to %.0f, of many within %.0f %%\n", (double)least,
           (double)most, (double)(100 * spread));
    TEST_ASSERT_TRUE(most > 2 * least);
    TEST_ASSERT_TRUE(spread < 0.3F);
}

static void one_bad_pose_does_not_decide(void)
{
    rng r = rng_seed(224);
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_focal_start(&focal, 1000, 800));
    for (int k = 0; k < 20; k++) {
        someone(&r, 800, 3, 0.02F);
        add();
    }
    const float before = found();
    someone(&r, 3000, 1.6F, 0.15F);
    (void)edml_focal_add(&focal, &pose, in, &work, sizeof work);
    TEST_ASSERT_FLOAT_WITHIN(0.1F, 0, logf(found() / before));
}

static void expect(edml_status status)
{
    const edml_focal before = focal;
    TEST_ASSERT_EQUAL_INT(status, edml_focal_add(&focal, &pose, in, &work, sizeof work));
    TEST_ASSERT_SAME_BYTES(before, focal);
}

static void what_has_no_place_says_nothing(void)
{
    rng r = rng_seed(225);
    memset(&focal, 0, sizeof focal);
    someone(&r, 1000, 3, 0);
    expect(EDML_ERR_CAMERA); /* not started */
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_focal_start(&focal, 1000, 800));
    TEST_ASSERT_EQUAL_INT(EDML_ERR_CAMERA, edml_focal_camera(&camera, &focal));
    in[3].x = NAN;
    expect(EDML_ERR_NOT_FINITE);
    someone(&r, 1000, 3, 0);
    for (int j = 0; j < 8; j++) in[j].c = 0;
    expect(EDML_ERR_TOO_FEW_JOINTS);
    someone(&r, 1000, 3, 0);
    for (int j = 0; j < EDML_JOINTS; j++) in[j].y = in[j].x;
    expect(EDML_ERR_DEGENERATE);
    someone(&r, 1000, 3, 0);
    TEST_ASSERT_EQUAL_INT(EDML_ERR_ARGUMENT, edml_focal_add(NULL, &pose, in, &work, sizeof work));
    TEST_ASSERT_EQUAL_INT(EDML_ERR_ARGUMENT, edml_focal_add(&focal, NULL, in, &work, sizeof work));
    TEST_ASSERT_EQUAL_INT(EDML_ERR_ARGUMENT, edml_focal_add(&focal, &pose, NULL, &work, sizeof work));
    TEST_ASSERT_EQUAL_INT(EDML_ERR_ARGUMENT, edml_focal_add(&focal, &pose, in, NULL, sizeof work));
    TEST_ASSERT_EQUAL_INT(EDML_ERR_ARGUMENT, edml_focal_camera(NULL, &focal));
    TEST_ASSERT_EQUAL_INT(EDML_ERR_ARGUMENT, edml_focal_camera(&camera, NULL));
}

static void it_needs_the_size_of_the_image(void)
{
    static const float sizes[][2] = {{640, 0},   {640, -480}, {0, 480},        {-640, 480},
                                     {640, NAN}, {NAN, 480},  {INFINITY, 480}, {640, INFINITY}};
    memset(&focal, 0x5A, sizeof focal);
    for (int n = 0; n < 8; n++) {
        const edml_focal before = focal;
        TEST_ASSERT_EQUAL_INT(EDML_ERR_CAMERA, edml_focal_start(&focal, sizes[n][0], sizes[n][1]));
        TEST_ASSERT_SAME_BYTES(before, focal);
    }
    TEST_ASSERT_EQUAL_INT(EDML_ERR_ARGUMENT, edml_focal_start(NULL, 640, 480));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(near_people_in_exact_poses_show_it);
    RUN_TEST(people_who_say_nothing_have_a_usual_camera);
    RUN_TEST(many_poses_give_one_that_hardly_moves);
    RUN_TEST(one_bad_pose_does_not_decide);
    RUN_TEST(what_has_no_place_says_nothing);
    RUN_TEST(it_needs_the_size_of_the_image);
    return UNITY_END();
}
