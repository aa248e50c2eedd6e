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
static const edml_model *const models[] = {&DISTANCES, &DIRECT, &FCONN};
enum { MODELS = 3 };

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

static edml_status lift_up(edml_pose *out, const edml_model *model, const point_f32 *up)
{
    edml_point native = {0, 0, 0};
    if (up != NULL) native = to_api_point(*up);
    return edml_lift(out, in, up != NULL ? &native : NULL, model, &work, sizeof work);
}

static edml_status lift_with(edml_pose *out, const edml_model *model) { return lift_up(out, model, NULL); }

static edml_status run(edml_pose *out) { return lift_with(out, &DIRECT); }

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
    TEST_ASSERT_TRUE(pose.misfit == again.misfit && pose.seen == again.seen);
}

/* Of the same joints: how far apart they are and their misfits. */
static float difference(void)
{
    const pose_f32 a = from_pose(&pose), b = from_pose(&again);
    TEST_ASSERT_EQUAL_INT(a.seen, b.seen);
    return worse(worst_joint_error(a.joint, b.joint), fabsf(a.misfit - b.misfit));
}

static float error_to(const point_f32 expected[EDML_JOINTS])
{
    const pose_f32 found = from_pose(&pose);
    return worst_joint_error(found.joint, expected);
}

static void check_all_finite(void)
{
    const pose_f32 found = from_pose(&pose);
    TEST_ASSERT_TRUE(all_finite(&found, 3 * EDML_JOINTS + 1));
    TEST_ASSERT_TRUE(found.misfit >= 0);
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
    SET_PARAM(model.fusion[FUSION_SHARE], 0);    /* it needs no image */
    SET_PARAM(model.fusion[FUSION_NEARNESS], 0); /* which is orthographic */
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
        TEST_ASSERT_EQUAL_INT(EDML_OK, lift_with(&pose, &model));
        const pose_f32 found = from_pose(&pose);
        TEST_ASSERT_ERROR_UP_TO(LIFT_SHAPE_TOLERANCE, worst_distance_error(found.joint, truth));
        TEST_ASSERT_ERROR_UP_TO(LIFT_TOLERANCE, found.misfit);
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

/* ... that gives points, in the body's frame: rows and mirror rows. */
static real known_rows[64];

static void know_points(real *out, const real *in_, const edml_model *model, void *scratch)
{
    (void)in_;
    (void)model;
    (void)scratch;
    memcpy(out, known_rows, sizeof known_rows);
}

static void know_person(const point_f32 person[EDML_JOINTS], edml_image_point down)
{
    static const int first[] = {EDML_HEAD,    EDML_NECK_BASE, EDML_R_SHOULDER, EDML_R_ELBOW,
                                EDML_R_WRIST, EDML_R_HIP,     EDML_R_KNEE,     EDML_R_ANKLE};
    const float u = from_real(down.u), v = from_real(down.v);
    for (int k = 0; k < 8; k++) {
        for (int mirrored = 0; mirrored < 2; mirrored++) {
            const point_f32 p = person[mirrored ? edml_mirror_joint[first[k]] : first[k]];
            const float x = v * p.x - u * p.y;
            known_rows[32 * mirrored + k] = to_real(mirrored ? -x : x);
            known_rows[32 * mirrored + 8 + k] = to_real(u * p.x + v * p.y);
            known_rows[32 * mirrored + 16 + k] = to_real(p.z);
            known_rows[32 * mirrored + 24 + k] = to_real(-100); /* share 0.0006 */
        }
    }
}

static void true_points_give_the_true_pose(void)
{
    point_f32 person[EDML_JOINTS];
    edml_image framed;
    edml_model model = DIRECT;
    model.PREDICT = know_points;
    SET_PARAM(model.fusion[FUSION_NEARNESS], 0);
    rng r = rng_seed(64);
    for (int n = 0; n < 100; n++) {
        random_human(&r, person);
        rotate_points(person, random_rotation(&r), person);
        root_at_mid_hip(person);
        photograph(image, person);
        use_image();
        for (int j = 0; j < n % 5; j++) in[3 * j].c = 0;
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_body_frame(&framed, in, 10, model.imputation));
        know_person(person, framed.down);
        TEST_ASSERT_EQUAL_INT(EDML_OK, lift_with(&pose, &model));
        TEST_ASSERT_ERROR_UP_TO(LIFT_POINTS_TOLERANCE, error_to(person));
        TEST_ASSERT_ERROR_UP_TO(LIFT_MISFIT_TOLERANCE, from_pose(&pose).misfit);
    }
}

static void check_left_alone(edml_status expected, const edml_model *model)
{
    memset(&pose, 0xA5, sizeof pose);
    memcpy(&again, &pose, sizeof again);
    TEST_ASSERT_EQUAL_INT(expected, lift_with(&pose, model));
    TEST_ASSERT_SAME_BYTES(again, pose);
}

static void check_refused(edml_status expected)
{
    for (int m = 0; m < MODELS; m++) check_left_alone(expected, models[m]);
}

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
    for (uint32_t seed = 0; seed < 60; seed++) {
        someone(seed);
        TEST_ASSERT_EQUAL_INT(EDML_OK, lift_with(&pose, models[seed % MODELS]));
        check_all_finite();
        TEST_ASSERT_EQUAL_INT(ALL_SEEN, pose.seen);
        const edml_point a = pose.joint[EDML_R_HIP], b = pose.joint[EDML_L_HIP];
        TEST_ASSERT_ERROR_UP_TO(LIFT_ROUNDING, from_api(a.x + b.x));
        TEST_ASSERT_ERROR_UP_TO(LIFT_ROUNDING, from_api(a.y + b.y));
        TEST_ASSERT_ERROR_UP_TO(LIFT_ROUNDING, from_api(a.z + b.z));
    }
}

/* ---- A lift is its stages ------------------------------------------------------------------------- */

static edml_prediction said;
static edml_image framed;

/* How well the points of the MDS correlate with the network's on all three axes, 0 to 1: the nearer to zero, the
 * less clear it is whether they are mirrored. */
static float thinnest_correlation(const point x[EDML_JOINTS], const point onto[EDML_JOINTS])
{
    double m[3][3] = {{0}}, size = 1;
    point_f32 a[EDML_JOINTS], b[EDML_JOINTS];
    from_points(a, x);
    from_points(b, onto);
    for (int j = 0; j < EDML_JOINTS; j++)
        for (int k = 0; k < 9; k++) m[k / 3][k % 3] += (double)(&a[j].x)[k / 3] * (double)(&b[j].x)[k % 3];
    for (int k = 0; k < 3; k++) size *= sqrt(m[k][0] * m[k][0] + m[k][1] * m[k][1] + m[k][2] * m[k][2]);
    return (float)(fabs(m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                        m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                        m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])) /
                   size);
}

/* Points in the body's frame, of what the network said.  Returns how clearly it is this mirror image. */
static float find_points(point x[EDML_JOINTS], const edml_model *model)
{
    memcpy(x, said.x, sizeof said.x);
    if (!(model->gives & EDML_GIVES_DISTANCES)) return 1;
    edml_mds(x, said.distance, &other_work);
    edml_refine(x, said.distance, (edml_objective)model->objective, model->refine_steps, &other_work);
    if (!(model->gives & EDML_GIVES_POINTS)) {
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_orient(x, &framed));
        return from_real(edml_mirror(x, model));
    }
    const float clear = thinnest_correlation(x, said.x);
    edml_align(x, said.x, model);
    return clear;
}

/* Returns as find_points(). */
static float run_stages(edml_pose *out, const edml_model *model, const point *up)
{
    point x[EDML_JOINTS];
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_body_frame(&framed, in, 10, model->imputation));
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_predict(&said, &framed, up, model, &other_work, sizeof other_work));
    const float clear = find_points(x, model);
    out->misfit = TO_API(edml_fuse(x, &framed, said.share, model));
    out->seen = framed.seen;
    const edml_image_point down = framed.down;
    for (int j = 0; j < EDML_JOINTS; j++) {
        const point p = x[j];
        x[j].x = MUL(down.v, p.x) + MUL(down.u, p.y);
        x[j].y = MUL(down.v, p.y) - MUL(down.u, p.x);
    }
    const point a = x[EDML_R_HIP], b = x[EDML_L_HIP];
    for (int j = 0; j < EDML_JOINTS; j++) {
        out->joint[j].x = TO_API(x[j].x - (a.x + b.x) / 2);
        out->joint[j].y = TO_API(x[j].y - (a.y + b.y) / 2);
        out->joint[j].z = TO_API(x[j].z - (a.z + b.z) / 2);
    }
    return clear;
}

static void a_lift_is_its_stages(void)
{
    static const point_f32 above = {0, -1, 0};
    const point upwards = {0, -REAL(1.0), 0};
    edml_model without_imputation = FCONN;
    without_imputation.imputation = NULL;
    for (uint32_t seed = 1; seed <= 90; seed++) {
        const edml_model *const model = seed % 8 == 7 ? &without_imputation : models[seed % MODELS];
        const int known = seed % 4 == 0;
        someone(seed);
        if (seed % 5 == 0) in[EDML_R_KNEE].c = 0;
        TEST_ASSERT_EQUAL_INT(EDML_OK, lift_up(&pose, model, known ? &above : NULL));
        run_stages(&again, model, known ? &upwards : NULL);
        TEST_ASSERT_ERROR_UP_TO(LIFT_STAGES_TOLERANCE, difference());
    }
}

/* Is it so clear which mirror image it is that rounding does not decide? */
static int is_clear(const edml_model *model)
{
    edml_pose lifted;
    return run_stages(&lifted, model, NULL) > 0.02F;
}

/* ---- What does not matter, and what turns the pose --------------------------------------------------- */

static void moving_the_image_changes_no_bit(void)
{
    static const float by[][2] = {{4321, -1000}, {1, 0}, {-3000, 2000}, {7000, -7000}};
    for (uint32_t seed = 0; seed < 21; seed++) {
        for (int n = 0; n < 4; n++) {
            someone(seed);
            TEST_ASSERT_EQUAL_INT(EDML_OK, lift_with(&pose, models[seed % MODELS]));
            map(1, by[n][0], 1, by[n][1]);
            TEST_ASSERT_EQUAL_INT(EDML_OK, lift_with(&again, models[seed % MODELS]));
            check_same_numbers();
        }
    }
}

/* From half a pixel of height to over 5000; float goes much farther. */
static void scaling_the_image_by_a_power_of_two_changes_no_bit(void)
{
    static const int beyond[] = {-90, 90};
    for (uint32_t seed = 0; seed < 21; seed++) {
        for (int n = 0; n < 14 + LIFT_POWERS_BEYOND; n++) {
            const float scale = ldexpf(1, n < 14 ? n - 9 : beyond[n - 14]);
            someone(seed);
            map(1, -500, 1, -400); /* about the middle of the image */
            TEST_ASSERT_EQUAL_INT(EDML_OK, lift_with(&pose, models[seed % MODELS]));
            map(scale, 0, scale, 0);
            TEST_ASSERT_EQUAL_INT(EDML_OK, lift_with(&again, models[seed % MODELS]));
            check_same_numbers();
        }
    }
}

/* Other factors round the input, and by how much that moves a joint is the network's affair. */
static void scaling_the_image_hardly_moves_the_pose(void)
{
    for (uint32_t seed = 0; seed < 30; seed++) {
        someone(seed);
        if (!is_clear(models[seed % MODELS])) continue;
        TEST_ASSERT_EQUAL_INT(EDML_OK, lift_with(&again, models[seed % MODELS]));
        map(1.7F, 100, 1.7F, 50);
        TEST_ASSERT_EQUAL_INT(EDML_OK, lift_with(&pose, models[seed % MODELS]));
        TEST_ASSERT_ERROR_UP_TO(LIFT_SCALED_TOLERANCE, difference());
    }
}

static void roll(point_f32 *p, double c, double s)
{
    const point_f32 was = *p;
    p->x = (float)(c * (double)was.x - s * (double)was.y);
    p->y = (float)(s * (double)was.x + c * (double)was.y);
}

/* Upside down, on either side, and anything between; where up is turns along. */
static void rolling_the_camera_rolls_the_pose(void)
{
    rng r = rng_seed(65);
    float worst = 0;
    for (uint32_t seed = 0; seed < 240; seed++) {
        const edml_model *const model = models[seed % MODELS];
        const double quarters[] = {0, 90, 180, 270};
        const double degrees = seed % 2 ? quarters[seed / 2 % 4] : (double)uniform(&r, -180, 180);
        const double c = cos(degrees * 3.14159265358979 / 180), s = sin(degrees * 3.14159265358979 / 180);
        point_f32 up = {gauss(&r), gauss(&r), gauss(&r)};
        someone(seed);
        if (seed % 5 == 0) image[EDML_L_ANKLE].c = image[EDML_R_ELBOW].c = 0;
        map(1, -500, 1, -400);
        if (!is_clear(model)) continue;
        TEST_ASSERT_EQUAL_INT(EDML_OK, lift_up(&pose, model, seed % 3 ? &up : NULL));
        roll(&up, c, s);
        for (int j = 0; j < EDML_JOINTS; j++) {
            point_f32 at = {image[j].x, image[j].y, 0};
            roll(&at, c, s);
            image[j].x = at.x;
            image[j].y = at.y;
        }
        use_image();
        TEST_ASSERT_EQUAL_INT(EDML_OK, lift_up(&again, model, seed % 3 ? &up : NULL));
        pose_f32 turned = from_pose(&pose);
        const pose_f32 found = from_pose(&again);
        for (int j = 0; j < EDML_JOINTS; j++) roll(&turned.joint[j], c, s);
        worst = worse(worst, worst_joint_error(turned.joint, found.joint));
        worst = worse(worst, fabsf(turned.misfit - found.misfit));
    }
    printf("lift: camera rolled, worst joint %.3f mm\n", 1e3 * (double)worst);
    TEST_ASSERT_ERROR_UP_TO(LIFT_ROLLED_TOLERANCE, worst);
}

/* With distances alone, the mirrored image shows the same person from behind: a rotation about the vertical,
 * no reflection.  That is true of a camera far away, because what is nearer is larger. */
static void mirroring_the_image_rotates_a_pose_of_distances_about_the_vertical(void)
{
    edml_model model = FCONN;
    SET_PARAM(model.fusion[FUSION_NEARNESS], 0);
    for (uint32_t seed = 0; seed < 20; seed++) {
        someone(seed);
        TEST_ASSERT_EQUAL_INT(EDML_OK, lift_with(&pose, &model));
        map(-1, 0, 1, 0);
        TEST_ASSERT_EQUAL_INT(EDML_OK, lift_with(&again, &model));
        for (int j = 0; j < EDML_JOINTS; j++) {
            pose.joint[j].x = -pose.joint[j].x;
            pose.joint[j].z = -pose.joint[j].z;
        }
        TEST_ASSERT_ERROR_UP_TO(LIFT_REFLECTED_TOLERANCE, difference());
    }
}

/* A person and who looks at them from a mirror, right being left, are lifted alike. */
static void mirrored_people_give_mirrored_poses(void)
{
    rng r = rng_seed(66);
    float worst = 0;
    for (uint32_t seed = 0; seed < 100; seed++) {
        const edml_model *const model = seed % 2 ? &DIRECT : &DISTANCES;
        point_f32 up = {gauss(&r), gauss(&r), gauss(&r)};
        someone(seed);
        if (seed % 5 == 0) image[EDML_L_ANKLE].c = image[EDML_R_ELBOW].c = 0;
        use_image();
        if (!is_clear(model)) continue;
        TEST_ASSERT_EQUAL_INT(EDML_OK, lift_up(&pose, model, seed % 3 ? &up : NULL));
        keypoint_f32 was[EDML_JOINTS];
        memcpy(was, image, sizeof was);
        for (int j = 0; j < EDML_JOINTS; j++) {
            image[edml_mirror_joint[j]] = was[j];
            image[edml_mirror_joint[j]].x = 1000 - was[j].x;
        }
        use_image();
        up.x = -up.x;
        TEST_ASSERT_EQUAL_INT(EDML_OK, lift_up(&again, model, seed % 3 ? &up : NULL));
        const pose_f32 a = from_pose(&pose), b = from_pose(&again);
        point_f32 mirrored[EDML_JOINTS];
        for (int j = 0; j < EDML_JOINTS; j++) {
            mirrored[edml_mirror_joint[j]] = a.joint[j];
            mirrored[edml_mirror_joint[j]].x = -a.joint[j].x;
        }
        worst = worse(worst, worst_joint_error(mirrored, b.joint));
        worst = worse(worst, fabsf(a.misfit - b.misfit));
    }
    printf("lift: mirrored people, worst joint %.4f mm\n", 1e3 * (double)worst);
    TEST_ASSERT_ERROR_UP_TO(LIFT_MIRRORED_TOLERANCE, worst);
}

/* ---- Up -------------------------------------------------------------------------------------------- */

static void up_may_have_any_length(void)
{
    static const float powers[] = LIFT_UP_POWERS;
    static const point_f32 up = {0.25F, -0.75F, 0.5F};
    for (uint32_t seed = 0; seed < 20; seed++) {
        const edml_model *const model = seed % 2 ? &DIRECT : &DISTANCES;
        someone(seed);
        TEST_ASSERT_EQUAL_INT(EDML_OK, lift_up(&pose, model, &up));
        for (unsigned n = 0; n < sizeof powers / sizeof *powers; n++) {
            const point_f32 longer = {ldexpf(up.x, (int)powers[n]), ldexpf(up.y, (int)powers[n]),
                                      ldexpf(up.z, (int)powers[n])};
            TEST_ASSERT_EQUAL_INT(EDML_OK, lift_up(&again, model, &longer));
            check_same_numbers();
        }
        const point_f32 gravity = {9.81F * up.x, 9.81F * up.y, 9.81F * up.z};
        TEST_ASSERT_EQUAL_INT(EDML_OK, lift_up(&again, model, &gravity));
        TEST_ASSERT_ERROR_UP_TO(LIFT_SCALED_TOLERANCE, difference());
    }
}

static void up_counts_if_it_is_given_and_fconn_makes_no_use_of_it(void)
{
    static const point_f32 up = {0.25F, -0.75F, 0.5F};
    for (uint32_t seed = 0; seed < 9; seed++) {
        someone(seed);
        TEST_ASSERT_EQUAL_INT(EDML_OK, lift_with(&pose, models[seed % MODELS]));
        TEST_ASSERT_EQUAL_INT(EDML_OK, lift_up(&again, models[seed % MODELS], &up));
        if (models[seed % MODELS] == &FCONN)
            check_same_numbers();
        else
            TEST_ASSERT_TRUE(difference() > 0.0001F);
    }
}

static void bad_up_is_refused_by_every_model(void)
{
    static const point_f32 zero = {0, 0, 0}, negative_zero = {-0.0F, 0, -0.0F};
    static const float bad[] = LIFT_BAD_UP;
    for (int m = 0; m < MODELS; m++) {
        memset(&pose, 0xA5, sizeof pose);
        memcpy(&again, &pose, sizeof again);
        someone(3);
        TEST_ASSERT_EQUAL_INT(EDML_ERR_DEGENERATE, lift_up(&pose, models[m], &zero));
        TEST_ASSERT_EQUAL_INT(EDML_ERR_DEGENERATE, lift_up(&pose, models[m], &negative_zero));
        for (unsigned n = 0; n < 3 * sizeof bad / sizeof *bad; n++) {
            point_f32 up = {0, -1, 0};
            *(n % 3 == 0 ? &up.x : n % 3 == 1 ? &up.y : &up.z) = bad[n / 3];
            TEST_ASSERT_EQUAL_INT(EDML_ERR_NOT_FINITE, lift_up(&pose, models[m], &up));
        }
        TEST_ASSERT_SAME_BYTES(again, pose);
    }
}

/* ---- What was not seen -------------------------------------------------------------------------------- */

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
        const edml_model *const model = models[j % MODELS];
        someone((uint32_t)j + 100);
        in[j].c = 0;
        memset(&pose, 0, sizeof pose);
        TEST_ASSERT_EQUAL_INT(EDML_OK, lift_with(&pose, model));
        TEST_ASSERT_EQUAL_INT(ALL_SEEN & ~(1 << j), pose.seen);
        check_all_finite(); /* it is lifted nevertheless */
        for (int n = 0; n < 7; n++) {
            in[j].x = garbage[n];
            in[j].y = garbage[(n + 3) % 7];
            in[j].c = not_seen[n % 3];
            memset(&again, 0, sizeof again);
            TEST_ASSERT_EQUAL_INT(EDML_OK, lift_with(&again, model));
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
    for (int m = 0; m < MODELS; m++) {
        someone(0);
        for (int n = 0; n < EDML_JOINTS - models[m]->fewest_joints; n++) in[2 + n].c = 0;
        TEST_ASSERT_EQUAL_INT(EDML_OK, lift_with(&pose, models[m]));
        check_all_finite();
    }
}

/* ---- Re-entrant ---------------------------------------------------------------------------------- */

static void what_work_memory_held_does_not_matter(void)
{
    for (int m = 0; m < MODELS; m++) {
        someone(6);
        memset(&work, 0, sizeof work);
        TEST_ASSERT_EQUAL_INT(EDML_OK, lift_with(&pose, models[m]));
        memset(&work, 0xFF, sizeof work);
        TEST_ASSERT_EQUAL_INT(EDML_OK, lift_with(&again, models[m]));
        check_same_numbers();
    }
}

/* Another lift between two stages of one: what an interrupt or a second thread would do. */
static void interrupt(real *distance, const real *edm, const edml_model *model, void *scratch)
{
    edml_pose other;
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_lift(&other, copy, NULL, &DIRECT, &other_work, sizeof other_work));
    DISTANCES.PREDICT(distance, edm, model, scratch);
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_lift(&other, copy, NULL, &FCONN, &other_work, sizeof other_work));
}

static void a_lift_inside_a_lift_changes_no_bit(void)
{
    edml_model interrupted = DISTANCES;
    interrupted.PREDICT = interrupt;
    someone(8);
    memcpy(copy, in, sizeof copy);
    someone(7);
    TEST_ASSERT_EQUAL_INT(EDML_OK, lift_with(&pose, &DISTANCES));
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
    for (int j = 0; j <= EDML_JOINTS - DIRECT.fewest_joints; j++) in[j].c = 0;
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
        map(1, 0, 0, 240); /* a horizontal line */
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

/* However the body lies in the image: there is no aspect that is too wide. */
static void a_person_far_wider_than_high_is_lifted(void)
{
    for (uint32_t seed = 0; seed < 20; seed++) {
        someone(seed);
        map(1, -500, 1, -400);
        map(seed % 2 ? 20 : 1, 0, seed % 2 ? 1 : 0.1F, 0);
        TEST_ASSERT_EQUAL_INT(EDML_OK, lift_with(&pose, models[seed % MODELS]));
        check_all_finite();
    }
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
        TEST_ASSERT_EQUAL_INT(EDML_ERR_DEGENERATE, status);
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
    check_left_alone(EDML_ERR_MODEL, &edml_direct_f32);
    check_left_alone(EDML_ERR_MODEL, &edml_distances_f32);
}

/* The same network in both, so that only the other stages differ. */
static void it_is_the_float_lift_to_some_millimetres(void)
{
    static work_f32 float_work;
    static const point_f32 up = {0.3F, -0.8F, 0.4F};
    for (int m = 0; m < MODELS; m++) {
        float worst = 0;
        int compared = 0;
        for (uint32_t n = 1; n <= 300; n++) {
            pose_f32 expected;
            someone(n);
            for (int j = 0; j < EDML_JOINTS; j++)
                if (n % 4 == 0 && j % 5 == 2) image[j].c = 0;
            use_image();
            const point_f32 *const upwards = n % 3 ? &up : NULL;
            const edml_status status = lift_f32(&expected, image, upwards, models[m], &float_work);
            TEST_ASSERT_EQUAL_INT(status, lift_up(&pose, models[m], upwards));
            if (status != EDML_OK || !is_clear(models[m])) continue; /* rounding may decide */
            const pose_f32 found = from_pose(&pose);
            worst = worse(worst, worst_joint_error(expected.joint, found.joint));
            worst = worse(worst, fabsf(expected.misfit - found.misfit));
            compared++;
        }
        printf("fixed point beside float: %s, %d people, %.3f mm\n", edml_model_name(models[m]), compared,
               (double)(1000 * worst));
        TEST_ASSERT_ERROR_UP_TO(FIXED_LIFT_TOLERANCE, worst);
        TEST_ASSERT_TRUE(compared > 200);
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
        if (lift_with(&pose, models[n % MODELS]) != EDML_OK) continue;
        for (int j = 0; j < EDML_JOINTS; j++) {
            TEST_ASSERT_INT_WITHIN(8 * PIXEL, 0, pose.joint[j].x);
            TEST_ASSERT_INT_WITHIN(8 * PIXEL, 0, pose.joint[j].y);
            TEST_ASSERT_INT_WITHIN(8 * PIXEL, 0, pose.joint[j].z);
        }
        TEST_ASSERT_TRUE(pose.misfit >= 0);
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

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(true_distances_give_the_true_pose);
    RUN_TEST(narrow_images_keep_the_shape);
    RUN_TEST(true_points_give_the_true_pose);
    RUN_TEST(a_pose_that_cannot_be_rotated_to_the_camera_is_refused);
    RUN_TEST(a_person_is_lifted);
    RUN_TEST(a_lift_is_its_stages);
    RUN_TEST(moving_the_image_changes_no_bit);
    RUN_TEST(scaling_the_image_by_a_power_of_two_changes_no_bit);
    RUN_TEST(scaling_the_image_hardly_moves_the_pose);
    RUN_TEST(rolling_the_camera_rolls_the_pose);
    RUN_TEST(mirroring_the_image_rotates_a_pose_of_distances_about_the_vertical);
    RUN_TEST(mirrored_people_give_mirrored_poses);
    RUN_TEST(up_may_have_any_length);
    RUN_TEST(up_counts_if_it_is_given_and_fconn_makes_no_use_of_it);
    RUN_TEST(bad_up_is_refused_by_every_model);
    RUN_TEST(a_missing_joints_coordinates_do_not_matter);
    RUN_TEST(two_missing_joints_coordinates_do_not_matter);
    RUN_TEST(how_confident_does_not_matter);
    RUN_TEST(the_fewest_joints_are_enough);
    RUN_TEST(what_work_memory_held_does_not_matter);
    RUN_TEST(a_lift_inside_a_lift_changes_no_bit);
    RUN_TEST(the_input_is_left_alone);
    RUN_TEST(too_few_joints_are_refused);
    RUN_TEST(images_without_a_shape_are_refused);
    RUN_TEST(a_person_far_wider_than_high_is_lifted);
#ifndef EDML_TEST_Q24
    RUN_TEST(not_finite_is_refused);
    RUN_TEST(huge_coordinates);
    RUN_TEST(one_huge_joint);
    RUN_TEST(tiny_coordinates);
    RUN_TEST(denormal_coordinates);
#else
    RUN_TEST(the_ends_of_the_range_are_not_finite);
    RUN_TEST(a_float_network_is_refused);
    RUN_TEST(it_is_the_float_lift_to_some_millimetres);
    RUN_TEST(a_person_from_end_to_end_is_lifted);
    RUN_TEST(boxes_at_the_ends_have_a_status);
    RUN_TEST(people_of_less_than_an_eighth_of_a_pixel_are_refused);
#endif
    return UNITY_END();
}
