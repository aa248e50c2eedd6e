/* lift/lift.h: the whole pipeline, what bad input gets, and how near fixed point is to float.
 *
 * SPDX-License-Identifier: MIT
 */
#include <float.h>
#include <stdio.h>

#include "native.h"
#include "network/model.h" /* to put a network of our own into a model */

static edml_work work, other_work;
static edml_pose pose, again;
static keypoint_f32 image[EDML_JOINTS]; /* in floats ... */
static edml_keypoint in[EDML_JOINTS];   /* ... and what is lifted */
static edml_keypoint copy[EDML_JOINTS];

static void use_image(void) { to_keypoints(in, image); }

/* A person of about 340 pixels, mid-hip near (500, 400), on whole pixels, so that sums, differences and halves
 * are exact. */
static void someone(uint32_t seed)
{
    rng r = rng_seed(seed);
    point_f32 x[EDML_JOINTS];
    random_human(&r, x);
    if (seed == 0) human_pose(x);
    photograph(image, x);
    for (int j = 0; j < EDML_JOINTS; j++) {
        image[j].x = floorf(image[j].x);
        image[j].y = floorf(image[j].y);
    }
    use_image();
}

static edml_status lift_with(edml_pose *out, const edml_model *model)
{
    return edml_lift(out, in, model, &work, sizeof work);
}

static edml_status run(edml_pose *out) { return lift_with(out, &FCONN); }

static void map(float ax, float bx, float ay, float by)
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        image[j].x = ax * image[j].x + bx;
        image[j].y = ay * image[j].y + by;
    }
    use_image();
}

static void check_same_numbers(void)
{
    for (int j = 0; j < EDML_JOINTS; j++)
        TEST_ASSERT_TRUE(pose.joint[j].x == again.joint[j].x && pose.joint[j].y == again.joint[j].y &&
                         pose.joint[j].z == again.joint[j].z);
    TEST_ASSERT_TRUE(pose.mirror_margin == again.mirror_margin && pose.residual == again.residual &&
                     pose.seen == again.seen);
}

/* The pose and another one, to the last bit in float; fixed point rounds halves up, on either side of zero. */
static void check_reflected_numbers(void)
{
    const pose_f32 a = from_pose(&pose), b = from_pose(&again);
    TEST_ASSERT_ERROR_UP_TO(LIFT_REFLECTED_TOLERANCE, worst_joint_error(a.joint, b.joint));
    TEST_ASSERT_ERROR_UP_TO(LIFT_REFLECTED_TOLERANCE, a.residual - b.residual);
    TEST_ASSERT_ERROR_UP_TO(LIFT_REFLECTED_MARGIN, a.mirror_margin - b.mirror_margin);
    TEST_ASSERT_EQUAL_INT(a.seen, b.seen);
}

static float error_to(const point_f32 expected[EDML_JOINTS])
{
    const pose_f32 found = from_pose(&pose);
    return worst_joint_error(found.joint, expected);
}

static void check_all_finite(void)
{
    const pose_f32 found = from_pose(&pose);
    TEST_ASSERT_TRUE(all_finite(&found, 3 * EDML_JOINTS + 2));
    TEST_ASSERT_TRUE(found.mirror_margin >= 0 && found.residual >= 0);
}

/* ---- With a network that knows the answer -------------------------------------------------------- */

static void know(real *distance, const real *edm, const edml_model *model, void *scratch)
{
    (void)edm;
    (void)scratch;
    memcpy(distance, model->layers, EDML_PAIRS * sizeof *distance);
}

static edml_model all_knowing(const real truth[EDML_PAIRS], edml_objective objective, int steps)
{
    edml_model model = FCONN;
    model.PREDICT = know;
    model.layers = truth;
    model.objective = (uint8_t)objective;
    model.refine_steps = (uint8_t)steps;
    SET_PARAM(model.fusion[0], 0); /* it needs no image */
    return model;
}

static void true_distances_give_the_true_pose(void)
{
    point_f32 person[EDML_JOINTS], rotated[EDML_JOINTS];
    float truth[EDML_PAIRS];
    real known[EDML_PAIRS];
    float worst = 0;
    rng r = rng_seed(61);
    human_pose(person);
    pair_distances(truth, person);
    to_reals(known, truth, EDML_PAIRS);
    for (int n = 0; n < 100; n++) {
        rotate_points(rotated, random_rotation(&r), person); /* the camera goes around */
        photograph(image, rotated);
        use_image();
        const edml_model model = all_knowing(known, (edml_objective)(n % 4), 5);
        const edml_status status = lift_with(&pose, &model);
        if (status != EDML_OK) { /* lying: wide for its height */
            TEST_ASSERT_EQUAL_INT(EDML_ERR_ASPECT, status);
            continue;
        }
        const pose_f32 found = from_pose(&pose);
        TEST_ASSERT_ERROR_UP_TO(LIFT_SHAPE_TOLERANCE, worst_distance_error(found.joint, truth));
        TEST_ASSERT_ERROR_UP_TO(LIFT_SHAPE_TOLERANCE, found.residual);
        TEST_ASSERT_TRUE(found.mirror_margin > 1);
        worst = worse(worst, worst_joint_error(found.joint, rotated));
    }
    printf("lift: true distances, worst joint %.1f mm\n", 1e3 * (double)worst);
    TEST_ASSERT_ERROR_UP_TO(LIFT_TOLERANCE, worst);
}

/* An image that is nearly a line: where the pose then looks is anybody's guess, but its shape must
 * stay. */
static void narrow_images_keep_the_shape(void)
{
    point_f32 person[EDML_JOINTS];
    float truth[EDML_PAIRS];
    real known[EDML_PAIRS];
    rng r = rng_seed(63);
    int lifted = 0;
    for (int n = 0; n < 400; n++) {
        random_human(&r, person);
        pair_distances(truth, person);
        to_reals(known, truth, EDML_PAIRS);
        photograph(image, person);
        const float slope = uniform(&r, -1, 1), width = ldexpf(1, -(n % 8));
        for (int j = 0; j < EDML_JOINTS; j++) image[j].x = slope * image[j].y + width * image[j].x;
        use_image();
        const edml_model model = all_knowing(known, EDML_STRESS_NONE, 0);
        if (lift_with(&pose, &model) != EDML_OK) continue;
        lifted++;
        const pose_f32 found = from_pose(&pose);
        TEST_ASSERT_ERROR_UP_TO(LIFT_SHAPE_TOLERANCE, worst_distance_error(found.joint, truth));
    }
    TEST_ASSERT_TRUE(lifted > 200);
}

static void residual_is_the_rms_difference_from_the_networks_distances(void)
{
    point_f32 person[EDML_JOINTS];
    float wanted[EDML_PAIRS], found[EDML_PAIRS];
    real known[EDML_PAIRS];
    rng r = rng_seed(62);
    human_pose(person);
    noisy_distances(&r, wanted, person, 0.1F);
    to_reals(known, wanted, EDML_PAIRS);
    photograph(image, person);
    use_image();
    const edml_model model = all_knowing(known, EDML_STRESS_RAW, 3);
    TEST_ASSERT_EQUAL_INT(EDML_OK, lift_with(&pose, &model));
    const pose_f32 lifted = from_pose(&pose);
    pair_distances(found, lifted.joint);
    double sum = 0;
    for (int n = 0; n < EDML_PAIRS; n++) {
        const double difference = (double)found[n] - (double)wanted[n];
        sum += difference * difference / EDML_PAIRS;
    }
    TEST_ASSERT_FLOAT_WITHIN(LIFT_ROUNDING, (float)sqrt(sum), lifted.residual);
}

static void check_left_alone(edml_status expected, const edml_model *model)
{
    memset(&pose, 0xA5, sizeof pose);
    memcpy(&again, &pose, sizeof again);
    TEST_ASSERT_EQUAL_INT(expected, lift_with(&pose, model));
    TEST_ASSERT_SAME_BYTES(again, pose);
}

static void check_refused(edml_status expected) { check_left_alone(expected, &FCONN); }

/* Points in one place or on a line, which look like no image of people. */
static void a_pose_that_cannot_be_rotated_to_the_camera_is_refused(void)
{
    point_f32 line[EDML_JOINTS];
    float distance[EDML_PAIRS] = {0};
    real known[EDML_PAIRS];
    for (int n = 0; n < 2; n++) {
        to_reals(known, distance, EDML_PAIRS);
        const edml_model model = all_knowing(known, EDML_STRESS_EQ2, 5);
        someone(0);
        check_left_alone(EDML_ERR_DEGENERATE, &model);
        for (int j = 0; j < EDML_JOINTS; j++) {
            const point_f32 at = {0.1F * (float)j, 0, 0};
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
        check_all_finite();
        TEST_ASSERT_EQUAL_INT(ALL_SEEN, pose.seen);
        TEST_ASSERT_ERROR_UP_TO(LIFT_ROUNDING,
                                from_api(pose.joint[EDML_R_HIP].z + pose.joint[EDML_L_HIP].z));
    }
}

static void a_lift_is_its_stages(void)
{
    const edml_model *const model = &FCONN;
    real edm[EDML_PAIRS], distance[EDML_PAIRS];
    point x[EDML_JOINTS];
    for (uint32_t seed = 1; seed <= 50; seed++) {
        someone(seed);
        if (seed % 3 == 0) in[EDML_R_KNEE].c = 0;
        TEST_ASSERT_EQUAL_INT(EDML_OK, run(&pose));
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_edm(edm, in, seed % 2 ? 4 : 10, REAL(3.0), model->imputation));
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_predict(distance, edm, model, &other_work, sizeof other_work));
        edml_mds(x, distance, &other_work);
        edml_refine(x, distance, (edml_objective)model->objective, model->refine_steps, &other_work);
        again.residual = TO_API(SQRT(edml_stress(x, distance, EDML_STRESS_RAW)));
        again.mirror_margin = TO_API(edml_mirror(x, model));
        again.seen = (uint16_t)(seed % 3 == 0 ? ALL_SEEN & ~(1 << EDML_R_KNEE) : ALL_SEEN);
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_orient(x, in, again.seen));
        edml_fuse(x, in, again.seen, model);
        for (int j = 0; j < EDML_JOINTS; j++) {
            again.joint[j].x = TO_API(x[j].x);
            again.joint[j].y = TO_API(x[j].y);
            again.joint[j].z = TO_API(x[j].z);
        }
        check_same_numbers();
    }
}

static void moving_the_image_changes_no_bit(void)
{
    static const float by[][2] = {{4321, -1000}, {1, 0}, {-3000, 2000}, {7000, -7000}};
    for (uint32_t seed = 0; seed < 20; seed++) {
        for (int n = 0; n < 4; n++) {
            someone(seed);
            TEST_ASSERT_EQUAL_INT(EDML_OK, run(&pose));
            map(1, by[n][0], 1, by[n][1]);
            TEST_ASSERT_EQUAL_INT(EDML_OK, run(&again));
            check_same_numbers();
        }
    }
}

/* From half a pixel of height to over 5000; float goes much farther. */
static void scaling_the_image_by_a_power_of_two_changes_no_bit(void)
{
    static const int beyond[] = {-90, 90};
    for (uint32_t seed = 0; seed < 20; seed++) {
        for (int n = 0; n < 14 + LIFT_POWERS_BEYOND; n++) {
            const float scale = ldexpf(1, n < 14 ? n - 9 : beyond[n - 14]);
            someone(seed);
            map(1, -500, 1, -400); /* about the middle of the image */
            TEST_ASSERT_EQUAL_INT(EDML_OK, run(&pose));
            map(scale, 0, scale, 0);
            TEST_ASSERT_EQUAL_INT(EDML_OK, run(&again));
            check_same_numbers();
        }
    }
}

/* Other factors round the input, and by how much that moves a joint is the network's affair. */
static void scaling_the_image_hardly_moves_the_pose(void)
{
    for (uint32_t seed = 0; seed < 20; seed++) {
        someone(seed);
        TEST_ASSERT_EQUAL_INT(EDML_OK, run(&again));
        const pose_f32 expected = from_pose(&again);
        if (expected.mirror_margin < 0.1F) continue; /* rounding might decide */
        map(1.7F, 100, 1.7F, 50);
        TEST_ASSERT_EQUAL_INT(EDML_OK, run(&pose));
        TEST_ASSERT_ERROR_UP_TO(LIFT_SCALED_TOLERANCE, error_to(expected.joint));
    }
}

/* All that the network sees is distances: the same shape, rotated as the image was. */
static void rotating_the_image_by_180_degrees_rotates_the_pose(void)
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
        check_reflected_numbers();
    }
}

/* The mirrored image shows the same person from behind: a rotation about the vertical, no reflection.  That
 * is true of a camera far away, because what is nearer is larger. */
static void mirroring_the_image_rotates_the_pose_about_the_vertical(void)
{
    edml_model model = FCONN;
    SET_PARAM(model.fusion[2], 0); /* 1 / distance */
    for (uint32_t seed = 0; seed < 20; seed++) {
        someone(seed);
        TEST_ASSERT_EQUAL_INT(EDML_OK, lift_with(&pose, &model));
        map(-1, 0, 1, 0);
        TEST_ASSERT_EQUAL_INT(EDML_OK, lift_with(&again, &model));
        for (int j = 0; j < EDML_JOINTS; j++) {
            pose.joint[j].x = -pose.joint[j].x;
            pose.joint[j].z = -pose.joint[j].z;
        }
        check_reflected_numbers();
    }
}

#ifndef EDML_TEST_Q24
static const pixels garbage[] = {NAN, INFINITY, -INFINITY, 3e38F, -1e30F, 1e-40F, 0};
static const confidence not_seen[] = {0, -1, -1e30F};
#else
static const pixels garbage[] = {0, 12345, INT32_MAX, INT32_MIN, -1, 1 << 29, -(1 << 29)};
static const confidence not_seen[] = {0, -1, INT16_MIN};
#endif

static void a_missing_joints_coordinates_do_not_matter(void)
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        someone((uint32_t)j + 100);
        in[j].c = 0;
        memset(&pose, 0, sizeof pose);
        TEST_ASSERT_EQUAL_INT(EDML_OK, run(&pose));
        TEST_ASSERT_EQUAL_INT(ALL_SEEN & ~(1 << j), pose.seen);
        check_all_finite(); /* it is lifted nevertheless */
        for (int n = 0; n < 7; n++) {
            in[j].x = garbage[n];
            in[j].y = garbage[(n + 3) % 7];
            in[j].c = not_seen[n % 3];
            memset(&again, 0, sizeof again);
            TEST_ASSERT_EQUAL_INT(EDML_OK, run(&again));
            TEST_ASSERT_SAME_BYTES(pose, again);
        }
    }
}

static void two_missing_joints_coordinates_do_not_matter(void)
{
    someone(5);
    in[EDML_L_WRIST].c = in[EDML_R_ANKLE].c = 0;
    TEST_ASSERT_EQUAL_INT(EDML_OK, run(&pose));
    TEST_ASSERT_EQUAL_INT(ALL_SEEN & ~(1 << EDML_L_WRIST | 1 << EDML_R_ANKLE), pose.seen);
    for (int n = 0; n < 7; n++) {
        in[EDML_L_WRIST].x = in[EDML_R_ANKLE].y = garbage[n];
        in[EDML_L_WRIST].y = in[EDML_R_ANKLE].x = garbage[6 - n];
        in[EDML_L_WRIST].c = not_seen[n % 3];
        TEST_ASSERT_EQUAL_INT(EDML_OK, run(&again));
        check_same_numbers();
    }
}

static void how_confident_does_not_matter(void)
{
#ifndef EDML_TEST_Q24
    static const confidence some[] = {1e-30F, 1e30F, 0.5F, 1};
#else
    static const confidence some[] = {1, INT16_MAX, 2001, 26001};
#endif
    for (uint32_t seed = 5; seed < 10; seed++) {
        someone(seed);
        TEST_ASSERT_EQUAL_INT(EDML_OK, run(&pose));
        for (int j = 0; j < EDML_JOINTS; j++) in[j].c = some[j % 4];
        TEST_ASSERT_EQUAL_INT(EDML_OK, run(&again));
        check_same_numbers();
    }
}

static void the_fewest_joints_are_enough(void)
{
    someone(0);
    for (int n = 0; n < EDML_JOINTS - FCONN.fewest_joints; n++) in[2 + n].c = 0;
    TEST_ASSERT_EQUAL_INT(EDML_OK, run(&pose));
    check_all_finite();
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
static void interrupt(real *distance, const real *edm, const edml_model *model, void *scratch)
{
    edml_pose other;
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_lift(&other, copy, &FCONN, &other_work, sizeof other_work));
    FCONN.PREDICT(distance, edm, model, scratch);
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_lift(&other, copy, &FCONN, &other_work, sizeof other_work));
}

static void a_lift_inside_a_lift_changes_no_bit(void)
{
    edml_model interrupted = FCONN;
    interrupted.PREDICT = interrupt;
    someone(8);
    memcpy(copy, in, sizeof copy);
    someone(7);
    TEST_ASSERT_EQUAL_INT(EDML_OK, run(&pose));
    TEST_ASSERT_EQUAL_INT(EDML_OK, lift_with(&again, &interrupted));
    check_same_numbers();
}

static void the_input_is_left_alone(void)
{
    someone(9);
    memcpy(copy, in, sizeof copy);
    TEST_ASSERT_EQUAL_INT(EDML_OK, run(&pose));
    TEST_ASSERT_SAME_BYTES(copy, in);
}

/* ---- Bad input ----------------------------------------------------------------------------------- */

#ifndef EDML_TEST_Q24

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

#else

enum { LIMIT = 1 << 29, PIXEL = 1 << 16 };

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

#endif

static void too_few_joints_are_refused(void)
{
    someone(0);
    for (int j = 0; j <= EDML_JOINTS - FCONN.fewest_joints; j++) in[j].c = 0;
    check_refused(EDML_ERR_TOO_FEW_JOINTS);
    for (int j = 0; j < EDML_JOINTS; j++) in[j].c = -1;
    check_refused(EDML_ERR_TOO_FEW_JOINTS);
}

static void images_without_a_shape_are_refused(void)
{
    for (uint32_t seed = 0; seed < 20; seed += 15) {
        someone(seed);
        map(0, 320, 0, 240); /* all points equal */
        check_refused(EDML_ERR_DEGENERATE);
        someone(seed);
        map(1, 0, 0, 240); /* no vertical extent */
        check_refused(EDML_ERR_DEGENERATE);
        someone(seed);
        map(0, 320, 1, 0); /* a vertical line */
        check_refused(EDML_ERR_DEGENERATE);
        someone(seed);
        for (int j = 0; j < EDML_JOINTS; j++) in[j].x = 300 - in[j].y; /* a slanted one */
        check_refused(EDML_ERR_DEGENERATE);
        for (int j = 0; j < EDML_JOINTS; j++) {
            image[j].x = (float)j;
            image[j].y = 2 * (float)j;
        }
        use_image();
        check_refused(EDML_ERR_DEGENERATE);
    }
}

static void a_person_far_wider_than_high_is_refused(void)
{
    for (uint32_t seed = 0; seed < 20; seed += 17) {
        someone(seed);
        map(1, -500, 1, 0);
        map(20, 0, 1, 0);
        check_refused(EDML_ERR_ASPECT);
    }
    someone(0);
    map(1, -500, 1, 0);
    map(100, 0, 1, 0); /* up to 7,000 pixels */
    check_refused(EDML_ERR_ASPECT);
}

#ifndef EDML_TEST_Q24 /* ---- The ends of float's range ---- */

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
        TEST_ASSERT_ERROR_UP_TO(LIFT_SCALED_TOLERANCE, error_to(again.joint));
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
        check_all_finite();
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

#else /* ---- The ends of fixed point's range, and float beside it ---- */

static void a_float_network_is_refused(void)
{
    someone(11);
    check_left_alone(EDML_ERR_MODEL, &edml_fconn_f32);
}

/* The same network in both, so that only the other stages differ. */
static void it_is_the_float_lift_to_a_millimetre(void)
{
    static work_f32 float_work;
    float worst = 0, worst_margin = 0;
    for (uint32_t n = 1; n <= 500; n++) {
        pose_f32 expected;
        someone(n);
        for (int j = 0; j < EDML_JOINTS; j++)
            if (n % 4 == 0 && j % 5 == 2) image[j].c = 0;
        use_image();
        const edml_status status = lift_f32(&expected, image, &FCONN, &float_work);
        TEST_ASSERT_EQUAL_INT(status, run(&pose));
        if (status != EDML_OK || expected.mirror_margin < 0.01F) continue; /* rounding may decide */
        const pose_f32 found = from_pose(&pose);
        worst = worse(worst, worst_joint_error(expected.joint, found.joint));
        worst_margin = worse(worst_margin, fabsf(expected.mirror_margin - found.mirror_margin));
    }
    printf("fixed point beside float: joints %.3f mm, margin %.5f\n", (double)(1000 * worst),
           (double)worst_margin);
    TEST_ASSERT_ERROR_UP_TO(FIXED_LIFT_TOLERANCE, worst);
    TEST_ASSERT_ERROR_UP_TO(FIXED_MARGIN_TOLERANCE, worst_margin);
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

#endif

/* Two joints that are each expected where the other one is: nothing is divided by zero. */
static void an_imputation_that_goes_round_in_a_circle_is_refused(void)
{
    real edm[EDML_PAIRS], untouched[EDML_PAIRS];
    edml_imputation circle = edml_default_imputation;
    memset(edm, 0x5A, sizeof edm);
    memset(untouched, 0x5A, sizeof untouched);
    memset(circle.weight[EDML_R_ELBOW], 0, sizeof circle.weight[0]);
    memset(circle.weight[EDML_R_WRIST], 0, sizeof circle.weight[0]);
    circle.weight[EDML_R_ELBOW][EDML_R_WRIST] = EDML_IMPUTATION_ONE;
    circle.weight[EDML_R_WRIST][EDML_R_ELBOW] = EDML_IMPUTATION_ONE;
    someone(16);
    in[EDML_R_ELBOW].c = in[EDML_R_WRIST].c = 0;
    TEST_ASSERT_EQUAL_INT(EDML_ERR_DEGENERATE, edml_edm(edm, in, 10, REAL(3.0), &circle));
    TEST_ASSERT_SAME_BYTES(untouched, edm);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(true_distances_give_the_true_pose);
    RUN_TEST(narrow_images_keep_the_shape);
    RUN_TEST(residual_is_the_rms_difference_from_the_networks_distances);
    RUN_TEST(a_pose_that_cannot_be_rotated_to_the_camera_is_refused);
    RUN_TEST(a_person_is_lifted);
    RUN_TEST(a_lift_is_its_stages);
    RUN_TEST(moving_the_image_changes_no_bit);
    RUN_TEST(scaling_the_image_by_a_power_of_two_changes_no_bit);
    RUN_TEST(scaling_the_image_hardly_moves_the_pose);
    RUN_TEST(rotating_the_image_by_180_degrees_rotates_the_pose);
    RUN_TEST(mirroring_the_image_rotates_the_pose_about_the_vertical);
    RUN_TEST(a_missing_joints_coordinates_do_not_matter);
    RUN_TEST(two_missing_joints_coordinates_do_not_matter);
    RUN_TEST(how_confident_does_not_matter);
    RUN_TEST(the_fewest_joints_are_enough);
    RUN_TEST(what_work_memory_held_does_not_matter);
    RUN_TEST(a_lift_inside_a_lift_changes_no_bit);
    RUN_TEST(the_input_is_left_alone);
    RUN_TEST(too_few_joints_are_refused);
    RUN_TEST(images_without_a_shape_are_refused);
    RUN_TEST(a_person_far_wider_than_high_is_refused);
    RUN_TEST(an_imputation_that_goes_round_in_a_circle_is_refused);
#ifndef EDML_TEST_Q24
    RUN_TEST(not_finite_is_refused);
    RUN_TEST(huge_coordinates);
    RUN_TEST(one_huge_joint);
    RUN_TEST(tiny_coordinates);
    RUN_TEST(denormal_coordinates);
#else
    RUN_TEST(the_ends_of_the_range_are_not_finite);
    RUN_TEST(a_float_network_is_refused);
    RUN_TEST(it_is_the_float_lift_to_a_millimetre);
    RUN_TEST(a_person_from_end_to_end_is_lifted);
    RUN_TEST(boxes_at_the_ends_have_a_status);
    RUN_TEST(people_of_less_than_an_eighth_of_a_pixel_are_refused);
#endif
    return UNITY_END();
}
