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

#ifndef EDML_TEST_Q24 /* whose placements round reprojections to 2^-16 */
/* Errors of the placements with each focal length over the size of the body; an eighth where there is none, or
 * where it is larger. */
static void errors_of(double error[EDML_FOCAL_LENGTHS])
{
    const double size = size_in_image(in);
    for (int n = 0; n < EDML_FOCAL_LENGTHS; n++) {
        edml_placement placed;
        const float f = 800 * 0.5F * powf(8, (float)n / 11);
        const edml_camera tried = {f, f, 500, 400};
        error[n] = 0.125;
        if (edml_place(&placed, &pose, in, &tried, &work, sizeof work) == EDML_OK)
            error[n] = fmin(0.125, (double)placed.reprojection / size);
    }
}

/* A pose's misfit is 3000 times its squared error beyond the least one, 4 at most; of poses it is the mean. */
static void a_misfit_is_the_mean_of_squared_errors(void)
{
    rng r = rng_seed(226);
    int most = 0, beyond = 0;
    for (int n = 0; n < 12; n++) {
        double sum[EDML_FOCAL_LENGTHS] = {0};
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_focal_start(&focal, 1000, 800));
        for (int k = 1; k <= 5; k++) {
            double error[EDML_FOCAL_LENGTHS], least = 0.125;
            someone(&r, n == 4 ? 330 : 500.0F + 100 * (float)n, n % 3 == 0 ? 1.7F : 4,
                    n % 2 ? 0.1F : 0.01F);
            if (n % 4 == 3) in[EDML_HEAD].c = in[EDML_L_ANKLE].c = 0;
            if (n == 7 || n == 8) in[EDML_HEAD].x += 500; /* whatever the focal length */
            if (edml_focal_add(&focal, &pose, in, &work, sizeof work) != EDML_OK) {
                k--;
                continue;
            }
            errors_of(error);
            for (int f = 0; f < EDML_FOCAL_LENGTHS; f++) least = fmin(least, error[f]);
            for (int f = 0; f < EDML_FOCAL_LENGTHS; f++) {
                const double misfit = 3000 * (error[f] * error[f] - least * least);
                most += misfit > 4;
                beyond += error[f] == 0.125;
                sum[f] += fmin(4, misfit);
                TEST_ASSERT_FLOAT_WITHIN(0.01F, (float)(sum[f] / k), focal.misfit[f]);
            }
        }
    }
    TEST_ASSERT_TRUE(most > 20 && beyond > 5);
}

/* The mean of the twelve, of a usual one by (ln f / 1.2)^2 / (2 0.5^2) and by its misfit. */
static void the_focal_length_is_the_mean_by_likelihood(void)
{
    rng r = rng_seed(227);
    for (int n = 0; n < 200; n++) {
        double least = 100, sum = 0, mean = 0, unlike[EDML_FOCAL_LENGTHS];
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_focal_start(&focal, 1000, 800));
        focal.poses = 3;
        for (int f = 0; f < EDML_FOCAL_LENGTHS; f++) {
            const double usual = log(0.5 * pow(8, f / 11.0) / 1.2);
            focal.misfit[f] = f == n % 13 ? 0 : uniform(&r, n % 2 ? 3.9F : 0, 4);
            unlike[f] = (double)focal.misfit[f] + usual * usual / 0.5;
            least = fmin(least, unlike[f]);
        }
        for (int f = 0; f < EDML_FOCAL_LENGTHS; f++) {
            const double weight = pow(1 + (unlike[f] - least) / 8, -8);
            sum += weight;
            mean += f * weight;
        }
        mean /= sum;
        const int below = mean < 10 ? (int)mean : 10;
        const double low = 400 * pow(8, below / 11.0), high = 400 * pow(8, (below + 1) / 11.0);
        TEST_ASSERT_FLOAT_WITHIN(0.05F, (float)(low + (mean - below) * (high - low)), found());
    }
    for (int f = 0; f < EDML_FOCAL_LENGTHS; f++) focal.misfit[f] = f == 11 ? 0 : 1e6F;
    TEST_ASSERT_FLOAT_WITHIN(1, 3200, found()); /* the last one, alone */
    for (int f = 0; f < EDML_FOCAL_LENGTHS; f++) focal.misfit[f] = f == 0 ? 0 : 1e6F;
    TEST_ASSERT_FLOAT_WITHIN(1, 400, found());
}

static void more_poses_than_can_be_counted_are_taken(void)
{
    rng r = rng_seed(228);
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_focal_start(&focal, 1000, 800));
    focal.poses = UINT16_MAX;
    someone(&r, 900, 3, 0);
    add();
    TEST_ASSERT_EQUAL_INT(UINT16_MAX, focal.poses);
}

static void work_memory_must_be_aligned(void)
{
    static edml_work two[2];
    rng r = rng_seed(229);
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_focal_start(&focal, 1000, 800));
    someone(&r, 900, 3, 0);
    const edml_focal before = focal;
    TEST_ASSERT_EQUAL_INT(EDML_ERR_ARGUMENT,
                          edml_focal_add(&focal, &pose, in, (char *)two + 1, sizeof *two));
    TEST_ASSERT_SAME_BYTES(before, focal);
}

/* Three quarters of the largest float high: some focal lengths are beyond it. */
static void an_image_as_large_as_floats_get_has_focal_lengths_that_are_none(void)
{
    const float unit = 3.2e35F;
    rng r = rng_seed(230);
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_focal_start(&focal, 1000 * unit, 800 * unit));
    someone(&r, 450, 3, 0);
    for (int j = 0; j < EDML_JOINTS; j++) {
        in[j].x *= unit;
        in[j].y *= unit;
    }
    add();
    TEST_ASSERT_TRUE(focal.misfit[0] < 4 && focal.misfit[EDML_FOCAL_LENGTHS - 1] == 4);
    for (int f = 0; f < EDML_FOCAL_LENGTHS; f++) focal.misfit[f] = f == 0 ? 0 : 1e6F;
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_focal_camera(&camera, &focal));
    const edml_camera before = camera;
    for (int f = 0; f < EDML_FOCAL_LENGTHS; f++) focal.misfit[f] = f == 11 ? 0 : 1e6F;
    TEST_ASSERT_EQUAL_INT(EDML_ERR_CAMERA, edml_focal_camera(&camera, &focal));
    TEST_ASSERT_SAME_BYTES(before, camera);
}
#endif

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
#ifndef EDML_TEST_Q24
    RUN_TEST(a_misfit_is_the_mean_of_squared_errors);
    RUN_TEST(the_focal_length_is_the_mean_by_likelihood);
    RUN_TEST(more_poses_than_can_be_counted_are_taken);
    RUN_TEST(work_memory_must_be_aligned);
    RUN_TEST(an_image_as_large_as_floats_get_has_focal_lengths_that_are_none);
#endif
    RUN_TEST(what_has_no_place_says_nothing);
    RUN_TEST(it_needs_the_size_of_the_image);
    return UNITY_END();
}
