/* lift/lift.h: the whole pipeline, and what bad input gets.
 *
 * SPDX-License-Identifier: MIT
 */
#include <float.h>
#include <stdio.h>

#include "helpers.h"
#include "network/model.h" /* to put a network of our own into a model */

static edml_work work, other_work;
static edml_pose pose, again;
static edml_keypoint in[EDML_JOINTS], whole[EDML_JOINTS];

/* A person on whole pixels, so that sums, differences and halves are exact. */
static void someone(uint32_t seed)
{
    rng r = rng_seed(seed);
    edml_point x[EDML_JOINTS];
    random_human(&r, x);
    if (seed == 0) human_pose(x);
    photograph(in, x);
    for (int j = 0; j < EDML_JOINTS; j++) {
        in[j].x = floorf(in[j].x);
        in[j].y = floorf(in[j].y);
    }
}

static edml_status run(edml_pose *out) { return edml_lift(out, in, &edml_fconn_f32, &work, sizeof work); }

static void map(float ax, float bx, float ay, float by)
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        in[j].x = ax * in[j].x + bx;
        in[j].y = ay * in[j].y + by;
    }
}

static void check_same_numbers(void)
{
    for (int j = 0; j < EDML_JOINTS; j++)
        TEST_ASSERT_TRUE(pose.joint[j].x == again.joint[j].x && pose.joint[j].y == again.joint[j].y &&
                         pose.joint[j].z == again.joint[j].z);
    TEST_ASSERT_TRUE(pose.mirror_margin == again.mirror_margin && pose.residual == again.residual &&
                     pose.seen == again.seen);
}

/* ---- With a network that knows the answer -------------------------------------------------------- */

static void know(float distance[EDML_PAIRS], const float edm[EDML_PAIRS], const edml_model *model,
                 void *scratch)
{
    (void)edm;
    (void)scratch;
    memcpy(distance, model->layers, EDML_PAIRS * sizeof *distance);
}

static edml_model all_knowing(const float truth[EDML_PAIRS], edml_objective objective, int steps)
{
    edml_model model = edml_fconn_f32;
    model.predict_f32 = know;
    model.layers = truth;
    model.objective = (uint8_t)objective;
    model.refine_steps = (uint8_t)steps;
    model.fusion[0].f32 = 0; /* it needs no image */
    return model;
}

static void true_distances_give_the_true_pose(void)
{
    edml_point person[EDML_JOINTS], turned[EDML_JOINTS];
    float truth[EDML_PAIRS];
    float worst = 0;
    rng r = rng_seed(61);
    human_pose(person);
    pair_distances(truth, person);
    for (int n = 0; n < 100; n++) {
        rotate_points(turned, random_rotation(&r), person); /* the camera goes around */
        photograph(in, turned);
        const edml_objective objective = (edml_objective)(n % 4);
        const edml_model model = all_knowing(truth, objective, 5);
        const edml_status status = edml_lift(&pose, in, &model, &work, sizeof work);
        if (status != EDML_OK) { /* lying: wide for its height */
            TEST_ASSERT_EQUAL_INT(EDML_ERR_ASPECT, status);
            continue;
        }
        TEST_ASSERT_ERROR_UP_TO(MDS_TOLERANCE, worst_distance_error(pose.joint, truth));
        TEST_ASSERT_ERROR_UP_TO(MDS_TOLERANCE, pose.residual);
        TEST_ASSERT_TRUE(pose.mirror_margin > 1);
        const float error = worst_joint_error(pose.joint, turned);
        worst = worse(worst, error);
    }
    printf("lift: true distances, worst joint %.1f mm\n", 1e3 * (double)worst);
    TEST_ASSERT_ERROR_UP_TO(LIFT_TOLERANCE, worst);
}

/* An image that is nearly a line: where the pose then looks is anybody's guess, but its shape must
 * stay. */
static void narrow_images_keep_the_shape(void)
{
    edml_point person[EDML_JOINTS];
    float truth[EDML_PAIRS];
    rng r = rng_seed(63);
    int lifted = 0;
    for (int n = 0; n < 400; n++) {
        random_human(&r, person);
        pair_distances(truth, person);
        photograph(in, person);
        const float slope = uniform(&r, -1, 1), width = ldexpf(1, -(n % 8));
        for (int j = 0; j < EDML_JOINTS; j++) in[j].x = slope * in[j].y + width * in[j].x;
        const edml_model model = all_knowing(truth, EDML_STRESS_NONE, 0);
        if (edml_lift(&pose, in, &model, &work, sizeof work) != EDML_OK) continue;
        lifted++;
        TEST_ASSERT_ERROR_UP_TO(MDS_TOLERANCE, worst_distance_error(pose.joint, truth));
    }
    TEST_ASSERT_TRUE(lifted > 200);
}

static void residual_is_the_rms_difference_from_the_networks_distances(void)
{
    edml_point person[EDML_JOINTS];
    float wanted[EDML_PAIRS], found[EDML_PAIRS];
    rng r = rng_seed(62);
    human_pose(person);
    noisy_distances(&r, wanted, person, 0.1F);
    photograph(in, person);
    const edml_model model = all_knowing(wanted, EDML_STRESS_RAW, 3);
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_lift(&pose, in, &model, &work, sizeof work));
    pair_distances(found, pose.joint);
    double sum = 0;
    for (int n = 0; n < EDML_PAIRS; n++) {
        const double difference = (double)found[n] - (double)wanted[n];
        sum += difference * difference / EDML_PAIRS;
    }
    TEST_ASSERT_FLOAT_WITHIN(ROUNDING, (float)sqrt(sum), pose.residual);
}

/* Points in one place or on a line, which look like no image of people. */
static void a_pose_that_cannot_be_turned_to_the_camera_is_refused(void)
{
    edml_point line[EDML_JOINTS];
    float distance[EDML_PAIRS] = {0};
    for (int n = 0; n < 2; n++) {
        const edml_model model = all_knowing(distance, EDML_STRESS_EQ2, 5);
        someone(0);
        memset(&pose, 0xA5, sizeof pose);
        memcpy(&again, &pose, sizeof again);
        TEST_ASSERT_EQUAL_INT(EDML_ERR_DEGENERATE, edml_lift(&pose, in, &model, &work, sizeof work));
        TEST_ASSERT_SAME_BYTES(again, pose);
        for (int j = 0; j < EDML_JOINTS; j++) {
            const edml_point at = {0.1F * (float)j, 0, 0};
            line[j] = at;
        }
        pair_distances(distance, line);
    }
}

/* ---- With the library's own ---------------------------------------------------------------------- */

static void a_person_is_lifted(void)
{
    for (uint32_t seed = 0; seed < 50; seed++) {
        someone(seed);
        TEST_ASSERT_EQUAL_INT(EDML_OK, run(&pose));
        TEST_ASSERT_TRUE(all_finite(&pose, 3 * EDML_JOINTS + 2));
        TEST_ASSERT_TRUE(pose.mirror_margin >= 0 && pose.residual >= 0);
        TEST_ASSERT_EQUAL_INT(ALL_SEEN, pose.seen);
        TEST_ASSERT_ERROR_UP_TO(ROUNDING, pose.joint[EDML_R_HIP].z + pose.joint[EDML_L_HIP].z);
    }
}

static void a_lift_is_its_stages(void)
{
    float edm[EDML_PAIRS], distance[EDML_PAIRS];
    edml_point x[EDML_JOINTS];
    someone(3);
    in[EDML_R_KNEE].c = 0;
    TEST_ASSERT_EQUAL_INT(EDML_OK, run(&pose));
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_edm(edm, in, 4, 100, edml_fconn_f32.imputation));
    edml_predict(distance, edm, &edml_fconn_f32, &work, sizeof work);
    edml_mds(x, distance, &work);
    edml_refine(x, distance, (edml_objective)edml_fconn_f32.objective, edml_fconn_f32.refine_steps, &work);
    again.residual = sqrtf(edml_stress(x, distance, EDML_STRESS_RAW));
    again.mirror_margin = edml_mirror(x, &edml_fconn_f32);
    again.seen = ALL_SEEN & ~(1 << EDML_R_KNEE);
    edml_orient(x, in, again.seen);
    edml_fuse(x, in, again.seen, &edml_fconn_f32);
    memcpy(again.joint, x, sizeof x);
    check_same_numbers();
}

static void moving_the_image_changes_no_bit(void)
{
    for (uint32_t seed = 0; seed < 20; seed++) {
        someone(seed);
        TEST_ASSERT_EQUAL_INT(EDML_OK, run(&pose));
        map(1, 4321, 1, -1000);
        TEST_ASSERT_EQUAL_INT(EDML_OK, run(&again));
        check_same_numbers();
    }
}

static void scaling_the_image_by_a_power_of_two_changes_no_bit(void)
{
    static const int power[] = {-3, 2, -90, 90};
    for (uint32_t seed = 0; seed < 20; seed++) {
        const float scale = ldexpf(1, power[seed % 4]);
        someone(seed);
        TEST_ASSERT_EQUAL_INT(EDML_OK, run(&pose));
        map(scale, 0, scale, 0);
        TEST_ASSERT_EQUAL_INT(EDML_OK, run(&again));
        check_same_numbers();
    }
}

/* Other factors round the input, and by how much that moves a joint is the network's affair. */
static void scaling_the_image_hardly_moves_the_pose(void)
{
    for (uint32_t seed = 0; seed < 20; seed++) {
        someone(seed);
        TEST_ASSERT_EQUAL_INT(EDML_OK, run(&pose));
        if (pose.mirror_margin < 0.1F) continue; /* rounding might decide */
        map(1.7F, 100, 1.7F, 50);
        TEST_ASSERT_EQUAL_INT(EDML_OK, run(&again));
        TEST_ASSERT_ERROR_UP_TO(LIFT_SCALED_TOLERANCE, worst_joint_error(pose.joint, again.joint));
    }
}

/* All that the network sees is distances: the same shape, turned as the image was. */
static void turning_the_image_by_180_degrees_turns_the_pose(void)
{
    for (uint32_t seed = 0; seed < 20; seed++) {
        someone(seed);
        TEST_ASSERT_EQUAL_INT(EDML_OK, run(&pose));
        map(-1, 0, -1, 0);
        TEST_ASSERT_EQUAL_INT(EDML_OK, run(&again));
        for (int j = 0; j < EDML_JOINTS; j++) {
            pose.joint[j].x = -pose.joint[j].x;
            pose.joint[j].y = -pose.joint[j].y;
        }
        check_same_numbers();
    }
}

/* The mirrored image shows the same person from behind: a turn about the vertical, no reflection. */
/* To a camera far away, that is: what is nearer is larger. */
static void mirroring_the_image_turns_the_pose_about_the_vertical(void)
{
    edml_model model = edml_fconn_f32;
    model.fusion[2].f32 = 0; /* 1 / distance */
    for (uint32_t seed = 0; seed < 20; seed++) {
        someone(seed);
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_lift(&pose, in, &model, &work, sizeof work));
        map(-1, 0, 1, 0);
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_lift(&again, in, &model, &work, sizeof work));
        for (int j = 0; j < EDML_JOINTS; j++) {
            pose.joint[j].x = -pose.joint[j].x;
            pose.joint[j].z = -pose.joint[j].z;
        }
        check_same_numbers();
    }
}

static void a_missing_joints_coordinates_do_not_matter(void)
{
    static const float garbage[] = {NAN, INFINITY, -INFINITY, 3e38F, -1e30F, 1e-40F, 0};
    for (int j = 0; j < EDML_JOINTS; j++) {
        someone((uint32_t)j + 100);
        in[j].c = 0;
        memset(&pose, 0, sizeof pose);
        TEST_ASSERT_EQUAL_INT(EDML_OK, run(&pose));
        TEST_ASSERT_EQUAL_INT(ALL_SEEN & ~(1 << j), pose.seen);
        TEST_ASSERT_TRUE(all_finite(&pose, 3 * EDML_JOINTS + 2)); /* it is lifted nevertheless */
        for (unsigned n = 0; n < sizeof garbage / sizeof *garbage; n++) {
            in[j].x = garbage[n];
            in[j].y = garbage[(n + 3) % 7];
            memset(&again, 0, sizeof again);
            TEST_ASSERT_EQUAL_INT(EDML_OK, run(&again));
            TEST_ASSERT_SAME_BYTES(pose, again);
        }
    }
}

static void how_confident_does_not_matter(void)
{
    someone(5);
    TEST_ASSERT_EQUAL_INT(EDML_OK, run(&pose));
    for (int j = 0; j < EDML_JOINTS; j++) in[j].c = j % 2 ? 1e-30F : 1e30F;
    TEST_ASSERT_EQUAL_INT(EDML_OK, run(&again));
    check_same_numbers();
}

static void the_fewest_joints_are_enough(void)
{
    someone(0);
    for (int n = 0; n < EDML_JOINTS - edml_fconn_f32.fewest_joints; n++) in[2 + n].c = 0;
    TEST_ASSERT_EQUAL_INT(EDML_OK, run(&pose));
    TEST_ASSERT_TRUE(all_finite(&pose, 3 * EDML_JOINTS + 2));
}

/* ---- Re-entrant ---------------------------------------------------------------------------------- */

static void what_work_memory_held_does_not_matter(void)
{
    someone(6);
    memset(&work, 0, sizeof work);
    TEST_ASSERT_EQUAL_INT(EDML_OK, run(&pose));
    memset(&work, 0xFF, sizeof work);
    TEST_ASSERT_EQUAL_INT(EDML_OK, run(&again));
    check_same_numbers();
}

/* Another lift between two stages of one: what an interrupt or a second thread would do. */
static void interrupt(float distance[EDML_PAIRS], const float edm[EDML_PAIRS], const edml_model *model,
                      void *scratch)
{
    edml_pose other;
    TEST_ASSERT_EQUAL_INT(EDML_OK,
                          edml_lift(&other, whole, &edml_fconn_f32, &other_work, sizeof other_work));
    edml_fconn_f32.predict_f32(distance, edm, model, scratch);
    TEST_ASSERT_EQUAL_INT(EDML_OK,
                          edml_lift(&other, whole, &edml_fconn_f32, &other_work, sizeof other_work));
}

static void a_lift_inside_a_lift_changes_no_bit(void)
{
    edml_model interrupted = edml_fconn_f32;
    interrupted.predict_f32 = interrupt;
    someone(8);
    memcpy(whole, in, sizeof whole);
    someone(7);
    TEST_ASSERT_EQUAL_INT(EDML_OK, run(&pose));
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_lift(&again, in, &interrupted, &work, sizeof work));
    check_same_numbers();
}

static void the_input_is_left_alone(void)
{
    someone(9);
    memcpy(whole, in, sizeof whole);
    TEST_ASSERT_EQUAL_INT(EDML_OK, run(&pose));
    TEST_ASSERT_SAME_BYTES(whole, in);
}

/* ---- Bad input ----------------------------------------------------------------------------------- */

static void check_refused(edml_status expected)
{
    memset(&pose, 0xA5, sizeof pose);
    memcpy(&again, &pose, sizeof again);
    TEST_ASSERT_EQUAL_INT(expected, run(&pose));
    TEST_ASSERT_SAME_BYTES(again, pose);
}

static void null_is_refused(void)
{
    someone(0);
    memset(&pose, 0xA5, sizeof pose);
    memcpy(&again, &pose, sizeof again);
    TEST_ASSERT_EQUAL_INT(EDML_ERR_ARGUMENT, edml_lift(NULL, in, &edml_fconn_f32, &work, sizeof work));
    TEST_ASSERT_EQUAL_INT(EDML_ERR_ARGUMENT, edml_lift(&pose, NULL, &edml_fconn_f32, &work, sizeof work));
    TEST_ASSERT_EQUAL_INT(EDML_ERR_ARGUMENT, edml_lift(&pose, in, NULL, &work, sizeof work));
    TEST_ASSERT_EQUAL_INT(EDML_ERR_ARGUMENT, edml_lift(&pose, in, &edml_fconn_f32, NULL, sizeof work));
    TEST_ASSERT_SAME_BYTES(again, pose);
}

static void not_finite_is_refused(void)
{
    static const float bad[] = {NAN, INFINITY, -INFINITY};
    for (int j = 0; j < EDML_JOINTS; j++) {
        for (int n = 0; n < 9; n++) {
            someone(0);
            float *member = n / 3 == 0 ? &in[j].x : n / 3 == 1 ? &in[j].y : &in[j].c;
            *member = bad[n % 3];
            check_refused(EDML_ERR_NOT_FINITE);
        }
    }
}

static void too_few_joints_are_refused(void)
{
    someone(0);
    for (int j = 0; j <= EDML_JOINTS - edml_fconn_f32.fewest_joints; j++) in[j].c = 0;
    check_refused(EDML_ERR_TOO_FEW_JOINTS);
    for (int j = 0; j < EDML_JOINTS; j++) in[j].c = -1;
    check_refused(EDML_ERR_TOO_FEW_JOINTS);
}

static void images_without_a_shape_are_refused(void)
{
    someone(0);
    map(0, 320, 0, 240); /* all points equal */
    check_refused(EDML_ERR_DEGENERATE);
    someone(0);
    map(1, 0, 0, 240); /* no vertical extent */
    check_refused(EDML_ERR_DEGENERATE);
    someone(0);
    map(0, 320, 1, 0); /* a vertical line */
    check_refused(EDML_ERR_DEGENERATE);
    someone(0);
    for (int j = 0; j < EDML_JOINTS; j++) in[j].x = 300 - in[j].y; /* a slanted one */
    check_refused(EDML_ERR_DEGENERATE);
}

static void a_person_far_wider_than_high_is_refused(void)
{
    someone(0);
    map(100, 0, 1, 0);
    check_refused(EDML_ERR_ASPECT);
}

/* ... gives the same pose or one as good, or a refusal, and never a number that is not finite. */
static void check_extreme(float scale)
{
    someone(0);
    TEST_ASSERT_EQUAL_INT(EDML_OK, run(&again));
    map(scale, 0, scale, 0);
    memset(&pose, 0xA5, sizeof pose);
    const edml_pose untouched = pose;
    const edml_status status = run(&pose);
    if (status != EDML_OK) {
        TEST_ASSERT_TRUE(status == EDML_ERR_DEGENERATE || status == EDML_ERR_ASPECT);
        TEST_ASSERT_SAME_BYTES(untouched, pose);
    } else {
        TEST_ASSERT_ERROR_UP_TO(LIFT_SCALED_TOLERANCE, worst_joint_error(pose.joint, again.joint));
    }
}

static void huge_coordinates(void)
{
    check_extreme(1e30F);
    check_extreme(3e35F); /* coordinates up to 1.7e38 */
    someone(0);
    map(3e38F / 600, 0, 3e38F / 600, 0);
    map(2, -3e38F, 2, -3e38F); /* differences overflow */
    memset(&pose, 0xA5, sizeof pose);
    memcpy(&again, &pose, sizeof again);
    if (run(&pose) == EDML_OK) {
        TEST_ASSERT_TRUE(all_finite(&pose, 3 * EDML_JOINTS + 2));
    } else {
        TEST_ASSERT_SAME_BYTES(again, pose);
    }
}

/* All others are one point beside it. */
static void one_huge_joint(void)
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        someone(0);
        in[j].x = 3e38F;
        check_refused(EDML_ERR_DEGENERATE);
        someone(0);
        in[j].y = -1e30F;
        check_refused(EDML_ERR_DEGENERATE);
    }
}

static void tiny_coordinates(void)
{
    check_extreme(1e-30F);
    check_extreme(FLT_MIN);
}

static void denormal_coordinates(void)
{
    check_extreme(FLT_MIN / 65536); /* coordinates of 1e-40, 100,000 of the smallest steps */
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(true_distances_give_the_true_pose);
    RUN_TEST(narrow_images_keep_the_shape);
    RUN_TEST(residual_is_the_rms_difference_from_the_networks_distances);
    RUN_TEST(a_pose_that_cannot_be_turned_to_the_camera_is_refused);
    RUN_TEST(a_person_is_lifted);
    RUN_TEST(a_lift_is_its_stages);
    RUN_TEST(moving_the_image_changes_no_bit);
    RUN_TEST(scaling_the_image_by_a_power_of_two_changes_no_bit);
    RUN_TEST(scaling_the_image_hardly_moves_the_pose);
    RUN_TEST(turning_the_image_by_180_degrees_turns_the_pose);
    RUN_TEST(mirroring_the_image_turns_the_pose_about_the_vertical);
    RUN_TEST(a_missing_joints_coordinates_do_not_matter);
    RUN_TEST(how_confident_does_not_matter);
    RUN_TEST(the_fewest_joints_are_enough);
    RUN_TEST(what_work_memory_held_does_not_matter);
    RUN_TEST(a_lift_inside_a_lift_changes_no_bit);
    RUN_TEST(the_input_is_left_alone);
    RUN_TEST(null_is_refused);
    RUN_TEST(not_finite_is_refused);
    RUN_TEST(too_few_joints_are_refused);
    RUN_TEST(images_without_a_shape_are_refused);
    RUN_TEST(a_person_far_wider_than_high_is_refused);
    RUN_TEST(huge_coordinates);
    RUN_TEST(one_huge_joint);
    RUN_TEST(tiny_coordinates);
    RUN_TEST(denormal_coordinates);
    return UNITY_END();
}
