/* network/fconv.h and lifts with it, with a small network: against NumPy, and against its own stages.
 * The shipped models are tested in tests/python/test_fconv.py.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>

#include "fconv_tiny.h"
#include "fconv_vectors.h"
#include "helpers.h"

enum { VECTORS = sizeof fconv_vectors / sizeof fconv_vectors[0] };

static edml_model f32, w8;
static edml_fconv_work work;
static edml_fconv_work_q work_q;
static edml_keypoint in[EDML_JOINTS];
static edml_keypoint_q in_q[EDML_JOINTS];
static edml_pose pose, again;

static void make_models(void)
{
    f32 = tiny_f32();
    w8 = tiny_w8();
}

static void load(float edm[EDML_PAIRS], int32_t edm_q24[EDML_PAIRS], int n)
{
    for (int k = 0; k < EDML_PAIRS; k++) {
        edm[k] = (float)fconv_vectors[n].edm[k] / 4096.0F;
        edm_q24[k] = fconv_vectors[n].edm[k] * 4096;
    }
}

/* A person on whole pixels, by both kinds of numbers. */
static void someone(uint32_t seed)
{
    rng r = rng_seed(seed);
    edml_point x[EDML_JOINTS];
    random_human(&r, x);
    photograph(in, x);
    if (seed % 3 == 0) in[seed % EDML_JOINTS].c = 0;
    for (int j = 0; j < EDML_JOINTS; j++) {
        in[j].x = floorf(in[j].x);
        in[j].y = floorf(in[j].y);
        in_q[j].x = (int32_t)in[j].x * 65536;
        in_q[j].y = (int32_t)in[j].y * 65536;
        in_q[j].c = (int16_t)(in[j].c > 0);
    }
}

/* ---- The network --------------------------------------------------------------------------------- */

/* As a lift runs it: on its work memory, in place. */
static void predict(float distance[EDML_PAIRS], const float edm[EDML_PAIRS], const edml_model *model)
{
    memcpy(work.lift.of.network.io.values, edm, EDML_PAIRS * sizeof *edm);
    edml__run_network(model, &work);
    memcpy(distance, work.lift.of.network.io.values, EDML_PAIRS * sizeof *distance);
}

static void predict_q(int32_t distance[EDML_PAIRS], const int32_t edm[EDML_PAIRS], const edml_model *model)
{
    memcpy(work_q.lift.of.network.io.values, edm, EDML_PAIRS * sizeof *edm);
    edml__run_network_q(model, &work_q);
    memcpy(distance, work_q.lift.of.network.io.values, EDML_PAIRS * sizeof *distance);
}

static void the_float_network_is_numpys(void)
{
    float edm[EDML_PAIRS], distance[EDML_PAIRS], worst = 0;
    int32_t whole[EDML_PAIRS];
    for (int n = 0; n < VECTORS; n++) {
        load(edm, whole, n);
        predict(distance, edm, &f32);
        for (int k = 0; k < EDML_PAIRS; k++)
            worst = worse(worst, (float)fabs((double)distance[k] - fconv_vectors[n].distance[k]));
    }
    printf("FConv against NumPy, worst: %.3g\n", (double)worst);
    TEST_ASSERT_ERROR_UP_TO(FCONV_TOLERANCE, worst);
}

static void integers_are_numpys_exactly(void)
{
    float edm[EDML_PAIRS], distance[EDML_PAIRS];
    int32_t whole[EDML_PAIRS];
    for (int n = 0; n < VECTORS; n++) {
        load(edm, whole, n);
        predict_q(whole, whole, &w8);
        TEST_ASSERT_EQUAL_INT32_ARRAY(fconv_vectors[n].whole, whole, EDML_PAIRS);
        predict(distance, edm, &w8);
        for (int k = 0; k < EDML_PAIRS; k++)
            TEST_ASSERT_TRUE(distance[k] == (float)fconv_vectors[n].whole[k] / 16777216.0F);
    }
}

/* But for the last, whose activations are beyond the largest of Q12. */
static void integers_are_near_floats(void)
{
    float worst = 0;
    for (int n = 0; n < VECTORS - 1; n++)
        for (int k = 0; k < EDML_PAIRS; k++)
            worst = worse(
                worst, (float)fabs(fconv_vectors[n].whole[k] / 16777216.0 - fconv_vectors[n].distance[k]));
    printf("FConv in integers beside float, worst: %.3g\n", (double)worst);
    TEST_ASSERT_ERROR_UP_TO(FCONV_W8_TOLERANCE, worst);
}

static void what_work_memory_held_does_not_matter(void)
{
    float edm[EDML_PAIRS], distance[EDML_PAIRS], other[EDML_PAIRS];
    int32_t whole[EDML_PAIRS], whole_other[EDML_PAIRS];
    load(edm, whole, 1);
    memset(&work, 0, sizeof work);
    predict(distance, edm, &f32);
    memset(&work, 0xFF, sizeof work); /* NaN */
    predict(other, edm, &f32);
    TEST_ASSERT_SAME_BYTES(distance, other);
    memset(&work_q, 0x7F, sizeof work_q);
    predict_q(whole_other, whole, &w8);
    TEST_ASSERT_EQUAL_INT32_ARRAY(fconv_vectors[1].whole, whole_other, EDML_PAIRS);
}

static void input_beyond_any_edm_is_limited(void)
{
    int32_t edm[EDML_PAIRS], distance[EDML_PAIRS];
    for (int n = 0; n < 2; n++) { /* 8, and the largest there is: both are 32767 in Q12 */
        for (int k = 0; k < EDML_PAIRS; k++) edm[k] = n == 0 ? 8 << 24 : INT32_MAX;
        predict_q(distance, edm, &w8);
        for (int k = 0; k < EDML_PAIRS; k++) TEST_ASSERT_TRUE(distance[k] >= 0 && distance[k] <= 3 << 24);
    }
}

static void distances_end_at_zero_and_three_metres(void)
{
    int32_t edm[EDML_PAIRS], distance[EDML_PAIRS];
    float floats[EDML_PAIRS];
    load(floats, edm, 0);
    tiny_bias[4][0] = 100 << 21;
    predict_q(distance, edm, &w8);
    for (int k = 0; k < EDML_PAIRS; k++) TEST_ASSERT_EQUAL_INT32(3 << 24, distance[k]);
    tiny_bias[4][0] = -(100 << 21);
    predict_q(distance, edm, &w8);
    for (int k = 0; k < EDML_PAIRS; k++) TEST_ASSERT_EQUAL_INT32(0, distance[k]);
    tiny_bias_f32[4][0] = -100;
    predict(floats, floats, &f32);
    for (int k = 0; k < EDML_PAIRS; k++) TEST_ASSERT_TRUE(floats[k] == 0);
    make_models();
}

/* ---- The lift ------------------------------------------------------------------------------------ */

static void a_lift_is_its_stages(void)
{
    static edml_prediction said;
    edml_image image;
    for (uint32_t n = 0; n < 10; n++) {
        someone(n);
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_lift(&pose, in, NULL, &f32, &work, sizeof work));
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_body_frame(&image, in, 10, f32.imputation));
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_predict(&said, &image, NULL, &f32, &work, sizeof work));
        edml_mds(said.x, said.distance, &work.lift);
        edml_refine(said.x, said.distance, (edml_objective)f32.objective, f32.refine_steps, &work.lift);
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_orient(said.x, &image));
        edml_mirror(said.x, &f32);
        TEST_ASSERT_TRUE(edml_fuse(said.x, &image, said.share, &f32) == pose.misfit);
        turn_to_camera(said.x, image.down);
        TEST_ASSERT_ERROR_UP_TO(ROUNDING, worst_joint_error(said.x, pose.joint));
    }
}

static void both_lifts_give_the_same_pose(void)
{
    edml_pose_q whole;
    float worst = 0;
    for (uint32_t n = 0; n < 10; n++) {
        someone(n);
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_lift(&pose, in, NULL, &w8, &work, sizeof work));
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_lift_q(&whole, in_q, NULL, &w8, &work_q, sizeof work_q));
        for (int j = 0; j < EDML_JOINTS; j++) {
            again.joint[j].x = (float)whole.joint[j].x / 65536.0F;
            again.joint[j].y = (float)whole.joint[j].y / 65536.0F;
            again.joint[j].z = (float)whole.joint[j].z / 65536.0F;
        }
        worst = worse(worst, worst_joint_error(pose.joint, again.joint));
        TEST_ASSERT_EQUAL_INT(pose.seen, whole.seen);
    }
    TEST_ASSERT_ERROR_UP_TO(FCONV_LIFT_TOLERANCE, worst);
}

static void bad_input_gets_its_status(void)
{
    someone(1);
    memset(&pose, 0x55, sizeof pose);
    again = pose;
    in[3].x = NAN;
    TEST_ASSERT_EQUAL_INT(EDML_ERR_NOT_FINITE, edml_lift(&pose, in, NULL, &f32, &work, sizeof work));
    for (int j = 0; j < 5; j++) in[j].c = 0;
    TEST_ASSERT_EQUAL_INT(EDML_ERR_TOO_FEW_JOINTS, edml_lift(&pose, in, NULL, &f32, &work, sizeof work));
    TEST_ASSERT_SAME_BYTES(again, pose);
}

/* In the same work memory. */
static void what_is_lifted_can_be_placed(void)
{
    static edml_work plain;
    edml_placement placement, other;
    const edml_camera camera = {1145, 1145, 500, 400};
    for (uint32_t n = 0; n < 10; n++) {
        someone(n);
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_lift(&pose, in, NULL, &f32, &work, sizeof work));
        const edml_status status = edml_place(&other, &pose, in, &camera, &plain, sizeof plain);
        TEST_ASSERT_EQUAL_INT(status, edml_place(&placement, &pose, in, &camera, &work, sizeof work));
        if (status == EDML_OK) TEST_ASSERT_EQUAL_MEMORY(other.joint, placement.joint, sizeof other.joint);
    }
}

/* The first frame is not filtered. */
static void a_video_takes_it(void)
{
    const edml_model *const models[] = {&f32, &w8, &edml_fconv_f32, &edml_fconv_w8};
    for (int n = 0; n < 4; n++) {
        edml_track track;
        edml_track_start(&track);
        someone(1);
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_lift(&again, in, NULL, models[n], &work, sizeof work));
        TEST_ASSERT_EQUAL_INT(EDML_OK,
                              edml_track_lift(&pose, &track, in, 7, NULL, models[n], &work, sizeof work));
        TEST_ASSERT_EQUAL_MEMORY(again.joint, pose.joint, sizeof pose.joint);
        TEST_ASSERT_EQUAL_INT(EDML_OK,
                              edml_track_lift(&pose, &track, in, 40, NULL, models[n], &work, sizeof work));
        TEST_ASSERT_ERROR_UP_TO(FCONV_LIFT_TOLERANCE, worst_joint_error(again.joint, pose.joint));
    }
}

/* ---- Models and their work memory ----------------------------------------------------------------- */

/* test_contract.c has what is refused. */
static void fconn_takes_the_larger_work_memory_as_well(void)
{
    static edml_work plain;
    static edml_work_q plain_q;
    edml_pose_q lifted, other;
    const edml_model *const models[] = {&edml_fconn_f32, &edml_fconn_w16, &edml_fconn_w8};
    someone(3);
    memset(&pose, 0, sizeof pose);
    memset(&again, 0, sizeof again);
    memset(&lifted, 0, sizeof lifted);
    memset(&other, 0, sizeof other);
    for (int n = 0; n < 3; n++) {
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_lift(&pose, in, NULL, models[n], &work, sizeof work));
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_lift(&again, in, NULL, models[n], &plain, sizeof plain));
        TEST_ASSERT_SAME_BYTES(again, pose);
        if (n == 0) continue;
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_lift_q(&lifted, in_q, NULL, models[n], &work_q, sizeof work_q));
        TEST_ASSERT_EQUAL_INT(EDML_OK,
                              edml_lift_q(&other, in_q, NULL, models[n], &plain_q, sizeof plain_q));
        TEST_ASSERT_SAME_BYTES(other, lifted);
    }
}

static void check_flipped_byte(const edml_model *model, void *byte)
{
    uint8_t *at = byte;
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_model_check(model));
    *at ^= 1;
    TEST_ASSERT_EQUAL_INT(EDML_ERR_MODEL, edml_model_check(model));
    *at ^= 1;
}

static void one_flipped_bit_is_noticed(void)
{
    check_flipped_byte(&f32, &tiny_weight_f32[0][0]);
    check_flipped_byte(&f32, &tiny_weight_f32[3][49 * 8 * 16 - 1]);
    check_flipped_byte(&f32, &tiny_bias_f32[4][0]);
    check_flipped_byte(&w8, &tiny_weight[4][0]);
    check_flipped_byte(&w8, &tiny_bias[1][15]);
    check_flipped_byte(&w8, &tiny_multiplier[2][7]);
}

static void work_memory_is_what_the_header_says(void)
{
    TEST_ASSERT_TRUE(sizeof work <= 22 * 1024);
    TEST_ASSERT_TRUE(sizeof work_q <= 14 * 1024);
}

int main(void)
{
    make_models();
    UNITY_BEGIN();
    RUN_TEST(the_float_network_is_numpys);
    RUN_TEST(integers_are_numpys_exactly);
    RUN_TEST(integers_are_near_floats);
    RUN_TEST(what_work_memory_held_does_not_matter);
    RUN_TEST(input_beyond_any_edm_is_limited);
    RUN_TEST(distances_end_at_zero_and_three_metres);
    RUN_TEST(a_lift_is_its_stages);
    RUN_TEST(both_lifts_give_the_same_pose);
    RUN_TEST(bad_input_gets_its_status);
    RUN_TEST(what_is_lifted_can_be_placed);
    RUN_TEST(a_video_takes_it);
    RUN_TEST(fconn_takes_the_larger_work_memory_as_well);
    RUN_TEST(one_flipped_bit_is_noticed);
    RUN_TEST(work_memory_is_what_the_header_says);
    return UNITY_END();
}
