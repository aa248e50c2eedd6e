/* The pipeline in fixed point: what it makes of whole numbers up to the ends of their range, and how
 * near it is to the float one.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>

#include "helpers.h"
#include "network/model.h" /* to put a network of our own into a model */

enum { PIXEL = 1 << 16, LIMIT = 1 << 29 };

static edml_work_q work, other_work;
static edml_pose_q pose, again;
static edml_keypoint_q in[EDML_JOINTS], whole[EDML_JOINTS];

/* A person of about 340 pixels, mid-hip near (500, 400), on whole pixels. */
static void someone(uint32_t seed)
{
    rng r = rng_seed(seed);
    edml_point x[EDML_JOINTS];
    edml_keypoint image[EDML_JOINTS];
    random_human(&r, x);
    if (seed == 0) human_pose(x);
    photograph(image, x);
    for (int j = 0; j < EDML_JOINTS; j++) {
        image[j].x = floorf(image[j].x);
        image[j].y = floorf(image[j].y);
    }
    to_q16(in, image);
}

static edml_status run(edml_pose_q *out)
{
    return edml_lift_q(out, in, &edml_fconn_w16, &work, sizeof work);
}

static void check_same_numbers(void)
{
    for (int j = 0; j < EDML_JOINTS; j++)
        TEST_ASSERT_TRUE(pose.joint[j].x == again.joint[j].x && pose.joint[j].y == again.joint[j].y &&
                         pose.joint[j].z == again.joint[j].z);
    TEST_ASSERT_TRUE(pose.mirror_margin == again.mirror_margin && pose.residual == again.residual &&
                     pose.seen == again.seen);
}

/* ---- Beside the float pipeline ------------------------------------------------------------------- */

/* The same network in both, so that only the other stages differ. */
static void it_is_the_float_lift_to_a_millimetre(void)
{
    static edml_work floats;
    float worst = 0, worst_margin = 0;
    for (uint32_t n = 1; n <= 500; n++) {
        edml_keypoint image[EDML_JOINTS];
        edml_pose expected, found;
        someone(n);
        for (int j = 0; j < EDML_JOINTS; j++) {
            if (n % 4 == 0 && j % 5 == 2) in[j].c = 0;
            image[j].x = (float)in[j].x / PIXEL;
            image[j].y = (float)in[j].y / PIXEL;
            image[j].c = in[j].c;
        }
        const edml_status status = edml_lift(&expected, image, &edml_fconn_w16, &floats, sizeof floats);
        TEST_ASSERT_EQUAL_INT(status, q24_lift(&found, image, &edml_fconn_w16, &floats, sizeof floats));
        if (status != EDML_OK || expected.mirror_margin < 0.01F) continue; /* rounding may decide */
        worst = worse(worst, worst_joint_error(expected.joint, found.joint));
        worst_margin = worse(worst_margin, fabsf(expected.mirror_margin - found.mirror_margin));
    }
    printf("fixed point beside float: joints %.3f mm, margin %.5f\n", (double)(1000 * worst),
           (double)worst_margin);
    TEST_ASSERT_ERROR_UP_TO(FIXED_LIFT_TOLERANCE, worst);
    TEST_ASSERT_ERROR_UP_TO(FIXED_MARGIN_TOLERANCE, worst_margin);
}

static void a_lift_is_its_stages(void)
{
    static int32_t edm[EDML_PAIRS], distance[EDML_PAIRS];
    edml_point_q24 x[EDML_JOINTS];
    for (uint32_t n = 1; n <= 50; n++) {
        someone(n);
        if (run(&pose) != EDML_OK) continue;
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_edm_q(edm, in, 10, 3 << 24, &edml_default_imputation));
        edml_predict_q(distance, edm, &edml_fconn_w16, &other_work, sizeof other_work);
        edml_mds_q(x, distance, &other_work);
        const int32_t margin = edml_mirror_q(x, &edml_fconn_w16);
        edml_orient_q(x, in, ALL_SEEN);
        edml_fuse_q(x, in, ALL_SEEN, &edml_fconn_w16);
        TEST_ASSERT_EQUAL_INT32((margin + 128) >> 8, pose.mirror_margin);
        for (int j = 0; j < EDML_JOINTS; j++) {
            TEST_ASSERT_EQUAL_INT32((x[j].x + 128) >> 8, pose.joint[j].x);
            TEST_ASSERT_EQUAL_INT32((x[j].y + 128) >> 8, pose.joint[j].y);
            TEST_ASSERT_EQUAL_INT32((x[j].z + 128) >> 8, pose.joint[j].z);
        }
    }
}

/* ---- What must not matter ------------------------------------------------------------------------ */

static void moving_the_image_changes_no_bit(void)
{
    static const int32_t by[][2] = {
        {PIXEL, 0}, {-3000 * PIXEL, 2000 * PIXEL}, {7000 * PIXEL, -7000 * PIXEL}};
    for (int n = 0; n < 3; n++) {
        someone(3);
        TEST_ASSERT_EQUAL_INT(EDML_OK, run(&pose));
        for (int j = 0; j < EDML_JOINTS; j++) {
            in[j].x += by[n][0];
            in[j].y += by[n][1];
        }
        TEST_ASSERT_EQUAL_INT(EDML_OK, run(&again));
        check_same_numbers();
    }
}

/* From half a pixel of height to over 5000. */
static void scaling_the_image_by_a_power_of_two_changes_no_bit(void)
{
    someone(4);
    for (int j = 0; j < EDML_JOINTS; j++) { /* about the middle of the image */
        in[j].x -= 500 * PIXEL;
        in[j].y -= 400 * PIXEL;
    }
    memcpy(whole, in, sizeof whole);
    TEST_ASSERT_EQUAL_INT(EDML_OK, run(&pose));
    for (int power = -9; power <= 4; power++) {
        const int32_t up = power > 0 ? 1 << power : 1, down = power < 0 ? 1 << -power : 1;
        for (int j = 0; j < EDML_JOINTS; j++) {
            in[j].x = whole[j].x * up / down;
            in[j].y = whole[j].y * up / down;
        }
        TEST_ASSERT_EQUAL_INT(EDML_OK, run(&again));
        check_same_numbers();
    }
}

static void a_missing_joints_coordinates_do_not_matter(void)
{
    static const int32_t anything[] = {0, 12345, INT32_MAX, INT32_MIN};
    someone(5);
    in[EDML_L_WRIST].c = in[EDML_R_ANKLE].c = 0;
    TEST_ASSERT_EQUAL_INT(EDML_OK, run(&pose));
    TEST_ASSERT_EQUAL_INT(ALL_SEEN & ~(1 << EDML_L_WRIST | 1 << EDML_R_ANKLE), pose.seen);
    for (int n = 0; n < 4; n++) {
        in[EDML_L_WRIST].x = in[EDML_R_ANKLE].y = anything[n];
        in[EDML_L_WRIST].y = in[EDML_R_ANKLE].x = anything[3 - n];
        in[EDML_L_WRIST].c = n % 2 ? INT16_MIN : 0;
        TEST_ASSERT_EQUAL_INT(EDML_OK, run(&again));
        check_same_numbers();
    }
}

static void how_confident_does_not_matter(void)
{
    someone(6);
    TEST_ASSERT_EQUAL_INT(EDML_OK, run(&pose));
    for (int j = 0; j < EDML_JOINTS; j++) in[j].c = (int16_t)(1 + 2000 * j);
    TEST_ASSERT_EQUAL_INT(EDML_OK, run(&again));
    check_same_numbers();
}

static void what_work_memory_held_does_not_matter(void)
{
    someone(7);
    memset(&work, 0, sizeof work);
    TEST_ASSERT_EQUAL_INT(EDML_OK, run(&pose));
    memset(&work, 0xFF, sizeof work);
    TEST_ASSERT_EQUAL_INT(EDML_OK, run(&again));
    check_same_numbers();
}

/* Another lift between two stages of one: what an interrupt or a second thread would do. */
static void interrupt(int32_t distance[EDML_PAIRS], const int32_t edm[EDML_PAIRS], const edml_model *model,
                      void *scratch)
{
    edml_pose_q other;
    TEST_ASSERT_EQUAL_INT(EDML_OK,
                          edml_lift_q(&other, whole, &edml_fconn_w16, &other_work, sizeof other_work));
    edml_fconn_w16.predict_q(distance, edm, model, scratch);
    TEST_ASSERT_EQUAL_INT(EDML_OK,
                          edml_lift_q(&other, whole, &edml_fconn_w16, &other_work, sizeof other_work));
}

static void a_lift_inside_a_lift_changes_no_bit(void)
{
    edml_model interrupted = edml_fconn_w16;
    interrupted.predict_q = interrupt;
    someone(8);
    memcpy(whole, in, sizeof whole);
    someone(9);
    TEST_ASSERT_EQUAL_INT(EDML_OK, run(&pose));
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_lift_q(&again, in, &interrupted, &work, sizeof work));
    check_same_numbers();
}

/* ---- Bad and extreme input ----------------------------------------------------------------------- */

static void check_refused(edml_status expected)
{
    memset(&pose, 0xA5, sizeof pose);
    memcpy(&again, &pose, sizeof again);
    TEST_ASSERT_EQUAL_INT(expected, run(&pose));
    TEST_ASSERT_SAME_BYTES(again, pose);
}

static void null_is_refused(void)
{
    someone(10);
    TEST_ASSERT_EQUAL_INT(EDML_ERR_ARGUMENT, edml_lift_q(NULL, in, &edml_fconn_w16, &work, sizeof work));
    TEST_ASSERT_EQUAL_INT(EDML_ERR_ARGUMENT, edml_lift_q(&pose, NULL, &edml_fconn_w16, &work, sizeof work));
    TEST_ASSERT_EQUAL_INT(EDML_ERR_ARGUMENT, edml_lift_q(&pose, in, NULL, &work, sizeof work));
    TEST_ASSERT_EQUAL_INT(EDML_ERR_ARGUMENT, edml_lift_q(&pose, in, &edml_fconn_w16, NULL, sizeof work));
}

static void a_float_network_is_refused(void)
{
    someone(11);
    TEST_ASSERT_EQUAL_INT(EDML_ERR_MODEL, edml_lift_q(&pose, in, &edml_fconn_f32, &work, sizeof work));
}

/* What a saturating conversion makes of infinity; the last coordinates inside are fine. */
static void the_ends_of_the_range_are_not_finite(void)
{
    static const int32_t outside[] = {LIMIT, LIMIT + 1, INT32_MAX, -LIMIT, -LIMIT - 1, INT32_MIN};
    for (int j = 0; j < EDML_JOINTS; j++) {
        for (int n = 0; n < 6; n++) {
            someone(12);
            in[j].x = outside[n];
            check_refused(EDML_ERR_NOT_FINITE);
            someone(12);
            in[j].y = outside[n];
            check_refused(EDML_ERR_NOT_FINITE);
        }
    }
}

/* The person's box fills the whole range. */
static void a_person_from_end_to_end_is_lifted(void)
{
    int32_t top = INT32_MAX, bottom = INT32_MIN;
    someone(0);
    TEST_ASSERT_EQUAL_INT(EDML_OK, run(&pose));
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (in[j].y < top) top = in[j].y;
        if (in[j].y > bottom) bottom = in[j].y;
    }
    const double scale = (2.0 * LIMIT - 2) / ((double)bottom - top);
    for (int j = 0; j < EDML_JOINTS; j++) {
        in[j].y = (int32_t)(scale * ((double)in[j].y - top)) - LIMIT + 1;
        in[j].x = (int32_t)(scale * ((double)in[j].x - 500.0 * PIXEL));
    }
    TEST_ASSERT_EQUAL_INT(EDML_OK, run(&again));
    for (int j = 0; j < EDML_JOINTS; j++) { /* rounded anew: a smooth network makes little of it */
        TEST_ASSERT_INT_WITHIN(PIXEL / 1000, pose.joint[j].x, again.joint[j].x);
        TEST_ASSERT_INT_WITHIN(PIXEL / 1000, pose.joint[j].y, again.joint[j].y);
        TEST_ASSERT_INT_WITHIN(PIXEL / 1000, pose.joint[j].z, again.joint[j].z);
    }
}

static void boxes_at_the_ends_have_a_status(void)
{
    rng r = rng_seed(74);
    for (int n = 0; n < 20000; n++) {
        for (int j = 0; j < EDML_JOINTS; j++) { /* corners, edges and what is near them */
            const int32_t ends[] = {LIMIT - 1, 1 - LIMIT, 0, (int32_t)(rng_bits(&r) >> 3) - (1 << 28)};
            in[j].x = ends[rng_bits(&r) >> 30] / (n % 3 + 1);
            in[j].y = ends[rng_bits(&r) >> 30];
            in[j].c = 1;
        }
        memset(&pose, 0xA5, sizeof pose);
        if (run(&pose) != EDML_OK) continue;
        for (int j = 0; j < EDML_JOINTS; j++) {
            TEST_ASSERT_INT_WITHIN(8 * PIXEL, 0, pose.joint[j].x);
            TEST_ASSERT_INT_WITHIN(8 * PIXEL, 0, pose.joint[j].y);
            TEST_ASSERT_INT_WITHIN(8 * PIXEL, 0, pose.joint[j].z);
        }
        TEST_ASSERT_TRUE(pose.residual >= 0 && pose.mirror_margin >= 0);
    }
}

static void people_of_less_than_an_eighth_of_a_pixel_are_refused(void)
{
    someone(14);
    for (int j = 0; j < EDML_JOINTS; j++) { /* 340 pixels to 0.08 */
        in[j].x = (in[j].x - 500 * PIXEL) / 4096;
        in[j].y = (in[j].y - 400 * PIXEL) / 4096;
    }
    check_refused(EDML_ERR_DEGENERATE);
}

/* Two joints that are each expected where the other one is: nothing is divided by zero. */
static void a_completion_that_goes_round_in_a_circle_is_refused(void)
{
    int32_t edm[EDML_PAIRS];
    edml_imputation circle = edml_default_imputation;
    memset(circle.weight[EDML_R_ELBOW], 0, sizeof circle.weight[0]);
    memset(circle.weight[EDML_R_WRIST], 0, sizeof circle.weight[0]);
    circle.weight[EDML_R_ELBOW][EDML_R_WRIST] = EDML_IMPUTATION_ONE;
    circle.weight[EDML_R_WRIST][EDML_R_ELBOW] = EDML_IMPUTATION_ONE;
    someone(16);
    in[EDML_R_ELBOW].c = in[EDML_R_WRIST].c = 0;
    TEST_ASSERT_EQUAL_INT(EDML_ERR_DEGENERATE, edml_edm_q(edm, in, 10, 3 << 24, &circle));
}

static void images_without_a_shape_are_refused(void)
{
    someone(15);
    for (int j = 0; j < EDML_JOINTS; j++) in[j].x = in[j].y = 77 * PIXEL;
    check_refused(EDML_ERR_DEGENERATE);
    for (int j = 0; j < EDML_JOINTS; j++) in[j].x = j * PIXEL;
    check_refused(EDML_ERR_DEGENERATE);
    for (int j = 0; j < EDML_JOINTS; j++) in[j].y = 2 * j * PIXEL;
    check_refused(EDML_ERR_DEGENERATE);
}

static void too_few_joints_are_refused(void)
{
    someone(16);
    for (int j = 0; j < 5; j++) in[j].c = 0;
    check_refused(EDML_ERR_TOO_FEW_JOINTS);
}

static void a_person_far_wider_than_high_is_refused(void)
{
    someone(17);
    for (int j = 0; j < EDML_JOINTS; j++) in[j].x = 20 * (in[j].x - 500 * PIXEL);
    check_refused(EDML_ERR_ASPECT);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(it_is_the_float_lift_to_a_millimetre);
    RUN_TEST(a_lift_is_its_stages);
    RUN_TEST(moving_the_image_changes_no_bit);
    RUN_TEST(scaling_the_image_by_a_power_of_two_changes_no_bit);
    RUN_TEST(a_missing_joints_coordinates_do_not_matter);
    RUN_TEST(how_confident_does_not_matter);
    RUN_TEST(what_work_memory_held_does_not_matter);
    RUN_TEST(a_lift_inside_a_lift_changes_no_bit);
    RUN_TEST(null_is_refused);
    RUN_TEST(a_float_network_is_refused);
    RUN_TEST(the_ends_of_the_range_are_not_finite);
    RUN_TEST(a_person_from_end_to_end_is_lifted);
    RUN_TEST(boxes_at_the_ends_have_a_status);
    RUN_TEST(people_of_less_than_an_eighth_of_a_pixel_are_refused);
    RUN_TEST(images_without_a_shape_are_refused);
    RUN_TEST(a_completion_that_goes_round_in_a_circle_is_refused);
    RUN_TEST(too_few_joints_are_refused);
    RUN_TEST(a_person_far_wider_than_high_is_refused);
    return UNITY_END();
}
