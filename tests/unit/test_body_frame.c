/* lift/body_frame.h: the image turned, moved and scaled to the body, and what is refused.
 *
 * SPDX-License-Identifier: MIT
 */
#include <float.h>
#include <stdio.h>

#include "as_float.h"

enum { FEWEST = 10 };

static edml_keypoint in[EDML_JOINTS];
static edml_image image, again;
static const edml_imputation *const imputation = &edml_default_imputation;

/* A person on whole pixels: sums, differences and halves are then exact. */
static void whole_pixels(rng *r)
{
    edml_point x[EDML_JOINTS];
    random_human(r, x);
    photograph(in, x);
    for (int j = 0; j < EDML_JOINTS; j++) {
        in[j].x = floorf(in[j].x);
        in[j].y = floorf(in[j].y);
    }
}

static void someone(void)
{
    edml_point x[EDML_JOINTS];
    human_pose(x);
    photograph(in, x);
}

static void hide(int count, rng *r)
{
    while (count > 0) {
        const int j = (int)(rng_bits(r) % EDML_JOINTS);
        count -= in[j].c > 0;
        in[j].c = 0;
    }
}

static edml_status run(edml_image *out) { return edml_body_frame(out, in, FEWEST, imputation); }

/* In the image's own axes. */
static edml_status run_upright(edml_image *out) { return edml_body_frame(out, in, FEWEST, NULL); }

static void check_run(edml_image *out)
{
    memset(out, 0, sizeof *out);
    TEST_ASSERT_EQUAL_INT(EDML_OK, run(out));
}

/* in -> a x + b, per axis */
static void map(float ax, float bx, float ay, float by)
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        in[j].x = ax * in[j].x + bx;
        in[j].y = ay * in[j].y + by;
    }
}

/* By an angle about (500, 400); positive: clockwise, as the axes are. */
static void roll(double degrees)
{
    const double angle = degrees * 3.14159265358979 / 180, c = cos(angle), s = sin(angle);
    for (int j = 0; j < EDML_JOINTS; j++) {
        const double x = (double)in[j].x - 500, y = (double)in[j].y - 400;
        in[j].x = (float)(500 + c * x - s * y);
        in[j].y = (float)(400 + s * x + c * y);
    }
}

static float worst_difference(const edml_image *a, const edml_image *b)
{
    float worst = 0;
    for (int j = 0; j < EDML_JOINTS; j++) {
        worst = worse(worst, fabsf(a->at[j].u - b->at[j].u));
        worst = worse(worst, fabsf(a->at[j].v - b->at[j].v));
    }
    return worst;
}

static float turned_by(const edml_image *a, const edml_image *b)
{
    return worse(fabsf(a->down.u - b->down.u), fabsf(a->down.v - b->down.v));
}

/* ---- Values: another way, in double ------------------------------------------------------------------- */

typedef struct {
    double x, y;
} place;

static place mean_place(const place at[EDML_JOINTS], uint16_t of)
{
    place mean = {0, 0};
    int count = 0;
    for (int j = 0; j < EDML_JOINTS; j++) count += of >> j & 1;
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (!(of >> j & 1)) continue;
        mean.x += at[j].x / count;
        mean.y += at[j].y / count;
    }
    return mean;
}

static uint16_t seen_ones(void)
{
    uint16_t seen = 0;
    for (int j = 0; j < EDML_JOINTS; j++)
        if (in[j].c > 0) seen = (uint16_t)(seen | 1 << j);
    return seen;
}

/* Pixels; each missing joint is brought to the weighted mean of all others, again and again. */
static void guess(place at[EDML_JOINTS], const edml_imputation *by)
{
    const uint16_t seen = seen_ones();
    const double start = (double)in[seen & 1 ? 0 : 1].x;
    for (int j = 0; j < EDML_JOINTS; j++) {
        at[j].x = seen >> j & 1 ? (double)in[j].x : start;
        at[j].y = seen >> j & 1 ? (double)in[j].y : start;
    }
    for (int round = 0; round < 5000; round++) {
        for (int j = 0; j < EDML_JOINTS; j++) {
            if (seen >> j & 1) continue;
            place sum = {0, 0};
            for (int i = 0; i < EDML_JOINTS; i++) {
                sum.x += at[i].x * by->weight[j][i] / EDML_IMPUTATION_ONE;
                sum.y += at[i].y * by->weight[j][i] / EDML_IMPUTATION_ONE;
            }
            at[j] = sum;
        }
    }
}

static void frame_of(edml_image *out, const edml_imputation *by)
{
    enum { UPPER = 1 << EDML_HEAD | 1 << EDML_NECK_BASE | 1 << EDML_R_SHOULDER | 1 << EDML_L_SHOULDER };
    place at[EDML_JOINTS], down = {0, 1};
    const uint16_t seen = seen_ones(), counted = by == NULL ? seen : ALL_SEEN;
    guess(at, &edml_default_imputation);
    if (by != NULL) {
        guess(at, by);
        const place upper = mean_place(at, UPPER);
        const place hips = mean_place(at, 1 << EDML_R_HIP | 1 << EDML_L_HIP);
        const double length = hypot(hips.x - upper.x, hips.y - upper.y);
        down.x = (hips.x - upper.x) / length;
        down.y = (hips.y - upper.y) / length;
    }
    double top = 1e9, bottom = -1e9, reach = 0;
    for (int j = 0; j < EDML_JOINTS; j++) {
        const place p = at[j];
        at[j].x = down.y * p.x - down.x * p.y;
        at[j].y = down.x * p.x + down.y * p.y;
    }
    const double mean = mean_place(at, counted).x;
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (!(seen >> j & 1)) continue;
        top = fmin(top, at[j].y);
        bottom = fmax(bottom, at[j].y);
        reach = fmax(reach, fabs(at[j].x - mean));
    }
    const double half = fmax((bottom - top) / 2, reach / 3.5);
    for (int j = 0; j < EDML_JOINTS; j++) {
        const double u = (at[j].x - mean) / half, v = (at[j].y - (top + bottom) / 2) / half;
        out->at[j].u = counted >> j & 1 ? (float)fmax(-3.9, fmin(3.9, u)) : 0;
        out->at[j].v = counted >> j & 1 ? (float)fmax(-3.9, fmin(3.9, v)) : 0;
    }
    out->down.u = (float)down.x;
    out->down.v = (float)down.y;
    out->seen = seen;
}

static void check_as_defined(const edml_imputation *by, float tolerance)
{
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_body_frame(&image, in, 5, by));
    frame_of(&again, by);
    TEST_ASSERT_ERROR_UP_TO(tolerance, worst_difference(&image, &again));
    TEST_ASSERT_ERROR_UP_TO(tolerance, turned_by(&image, &again));
    TEST_ASSERT_EQUAL_INT(again.seen, image.seen);
}

static void the_frame_is_as_defined(void)
{
    rng r = rng_seed(1);
    for (int n = 0; n < 200; n++) {
        whole_pixels(&r);
        hide(n % 8, &r);
        roll(n % 2 ? uniform(&r, -180, 180) : 0);
        check_as_defined(imputation, n % 8 == 0 ? FRAME_TOLERANCE : FRAME_GUESSED_TOLERANCE);
        check_as_defined(NULL, FRAME_TOLERANCE);
    }
}

/* As those of somebody who bends down and reaches out. */
static void what_is_wide_is_scaled_by_its_width(void)
{
    rng r = rng_seed(2);
    int widest = 0;
    for (int n = 0; n < 100; n++) {
        whole_pixels(&r);
        map(1, -500, 1, 0);
        map(uniform(&r, 1, 20), 500, 1, 0);
        hide(n % 4, &r);
        check_as_defined(imputation, FRAME_GUESSED_TOLERANCE);
        check_as_defined(NULL, FRAME_TOLERANCE);
        float reach = 0;
        for (int j = 0; j < EDML_JOINTS; j++)
            if (in[j].c > 0) reach = fmaxf(reach, fabsf(image.at[j].u));
        TEST_ASSERT_TRUE(reach <= 3.5F + FRAME_TOLERANCE);
        widest += reach > 3.5F - FRAME_TOLERANCE;
    }
    TEST_ASSERT_TRUE(widest > 20 && widest < 100);
}

static void joints_one_above_the_other_at_the_extremes_are_exactly_2_apart(void)
{
    someone();
    in[EDML_HEAD].x = in[EDML_L_ANKLE].x;
    TEST_ASSERT_EQUAL_INT(EDML_OK, run_upright(&image));
    TEST_ASSERT_TRUE(image.at[EDML_L_ANKLE].v == 1 && image.at[EDML_HEAD].v == -1);
    TEST_ASSERT_TRUE(image.at[EDML_L_ANKLE].u == image.at[EDML_HEAD].u);
}

static void down_is_a_unit_vector_and_the_hips_are_below_the_shoulders(void)
{
    rng r = rng_seed(3);
    for (int n = 0; n < 100; n++) {
        whole_pixels(&r);
        roll(uniform(&r, -180, 180));
        hide(n % 5, &r);
        check_run(&image);
        TEST_ASSERT_ERROR_UP_TO(FRAME_TOLERANCE, hypotf(image.down.u, image.down.v) - 1);
        const edml_image_point *at = image.at;
        const float across = (at[EDML_HEAD].u + at[EDML_NECK_BASE].u + at[EDML_R_SHOULDER].u +
                              at[EDML_L_SHOULDER].u) /
                                 4 -
                             (at[EDML_R_HIP].u + at[EDML_L_HIP].u) / 2;
        const float along = (at[EDML_R_HIP].v + at[EDML_L_HIP].v) / 2 -
                            (at[EDML_HEAD].v + at[EDML_NECK_BASE].v + at[EDML_R_SHOULDER].v +
                             at[EDML_L_SHOULDER].v) /
                                4;
        TEST_ASSERT_ERROR_UP_TO(ROUNDING, across);
        TEST_ASSERT_TRUE(along > 0);
    }
}

/* Head, neck and shoulders about the hips. */
static void without_an_axis_the_image_is_not_turned(void)
{
    someone();
    roll(40);
    for (int j = 0; j < EDML_JOINTS; j++) {
        const int right = j == EDML_R_SHOULDER || j == EDML_R_HIP;
        const int left = j == EDML_L_SHOULDER || j == EDML_L_HIP;
        if (!right && !left && j != EDML_HEAD && j != EDML_NECK_BASE) continue;
        in[j].x = 500 + (float)(16 * (left - right));
        in[j].y = 400 + (float)(8 * ((j == EDML_NECK_BASE) - (j == EDML_HEAD)));
    }
    check_run(&image);
    TEST_ASSERT_TRUE(image.down.u == 0 && image.down.v == 1);
    TEST_ASSERT_EQUAL_INT(EDML_OK, run_upright(&again));
    TEST_ASSERT_ERROR_UP_TO(FRAME_TOLERANCE, worst_difference(&image, &again));
}

/* Two joints that are expected far out, in opposite directions. */
static void guesses_end_at_the_border(void)
{
    edml_imputation far = edml_default_imputation;
    memset(far.weight[EDML_R_WRIST], 0, sizeof far.weight[0]);
    memset(far.weight[EDML_L_WRIST], 0, sizeof far.weight[0]);
    far.weight[EDML_R_WRIST][EDML_HEAD] = far.weight[EDML_L_WRIST][EDML_R_ANKLE] = 7 * EDML_IMPUTATION_ONE;
    far.weight[EDML_R_WRIST][EDML_R_ANKLE] = far.weight[EDML_L_WRIST][EDML_HEAD] = -6 * EDML_IMPUTATION_ONE;
    someone();
    in[EDML_R_WRIST].c = in[EDML_L_WRIST].c = 0;
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_body_frame(&image, in, FEWEST, &far));
    frame_of(&again, &far);
    TEST_ASSERT_ERROR_UP_TO(0, image.at[EDML_R_WRIST].v - again.at[EDML_R_WRIST].v);
    TEST_ASSERT_ERROR_UP_TO(0, image.at[EDML_L_WRIST].v - again.at[EDML_L_WRIST].v);
    for (int j = 0; j < EDML_JOINTS; j++)
        TEST_ASSERT_TRUE(!(in[j].c > 0) || fabsf(image.at[j].v) <= 1 + FRAME_TOLERANCE);
}

static void swapping_all_joints_of_right_and_left_in_a_mirror_mirrors_the_image(void)
{
    rng r = rng_seed(4);
    for (int n = 0; n < 100; n++) {
        whole_pixels(&r);
        roll(uniform(&r, -180, 180));
        hide(n % 5, &r);
        check_run(&image);
        edml_keypoint was[EDML_JOINTS];
        memcpy(was, in, sizeof was);
        for (int j = 0; j < EDML_JOINTS; j++) {
            in[edml_mirror_joint[j]] = was[j];
            in[edml_mirror_joint[j]].x = -was[j].x;
        }
        check_run(&again);
        for (int j = 0; j < EDML_JOINTS; j++) {
            const edml_image_point a = image.at[j], b = again.at[edml_mirror_joint[j]];
            TEST_ASSERT_FLOAT_WITHIN(FRAME_GUESSED_TOLERANCE, a.u, -b.u);
            TEST_ASSERT_FLOAT_WITHIN(FRAME_GUESSED_TOLERANCE, a.v, b.v);
        }
        TEST_ASSERT_FLOAT_WITHIN(FRAME_GUESSED_TOLERANCE, image.down.u, -again.down.u);
        TEST_ASSERT_FLOAT_WITHIN(FRAME_GUESSED_TOLERANCE, image.down.v, again.down.v);
    }
}

/* ---- Joints that are missing --------------------------------------------------------------------------- */

static void without_an_imputation_missing_joints_are_at_zero_and_others_stay(void)
{
    someone(); /* neither wrist is the highest or the lowest joint */
    TEST_ASSERT_EQUAL_INT(EDML_OK, run_upright(&image));
    in[EDML_R_WRIST].c = 0;
    TEST_ASSERT_EQUAL_INT(EDML_OK, run_upright(&again));
    TEST_ASSERT_TRUE(again.at[EDML_R_WRIST].u == 0 && again.at[EDML_R_WRIST].v == 0);
    TEST_ASSERT_EQUAL_INT(ALL_SEEN & ~(1 << EDML_R_WRIST), again.seen);
    TEST_ASSERT_TRUE(again.down.u == 0 && again.down.v == 1);
    float mean = 0; /* has moved across */
    for (int j = 0; j < EDML_JOINTS; j++) mean += again.at[j].u / (EDML_JOINTS - 1);
    TEST_ASSERT_ERROR_UP_TO(FRAME_TOLERANCE, mean);
    const float shift = again.at[EDML_HEAD].u - image.at[EDML_HEAD].u;
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (j == EDML_R_WRIST) continue;
        TEST_ASSERT_FLOAT_WITHIN(FRAME_TOLERANCE, image.at[j].u + shift, again.at[j].u);
        TEST_ASSERT_TRUE(image.at[j].v == again.at[j].v);
    }
}

static void a_missing_joints_coordinates_do_not_matter(void)
{
    static const float garbage[] = {NAN, INFINITY, -INFINITY, 3e38F, -1e30F, 1e-40F};
    for (int way = 0; way < 2; way++) {
        const edml_imputation *const by = way ? imputation : NULL;
        someone();
        in[EDML_L_KNEE].c = in[EDML_L_ANKLE].c = -1;
        memset(&image, 0, sizeof image);
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_body_frame(&image, in, FEWEST, by));
        for (unsigned n = 0; n < sizeof garbage / sizeof *garbage; n++) {
            in[EDML_L_KNEE].x = in[EDML_L_ANKLE].y = garbage[n];
            in[EDML_L_KNEE].y = garbage[n];
            memset(&again, 0, sizeof again);
            TEST_ASSERT_EQUAL_INT(EDML_OK, edml_body_frame(&again, in, FEWEST, by));
            TEST_ASSERT_SAME_BYTES(image, again);
        }
    }
}

static void how_confident_does_not_matter(void)
{
    someone();
    check_run(&image);
    for (int j = 0; j < EDML_JOINTS; j++) in[j].c = j % 2 ? 1.0F / 32768 : 3e38F;
    check_run(&again);
    TEST_ASSERT_SAME_BYTES(image, again);
}

static void weights_of_a_guess_add_up_to_one_and_are_the_same_for_left_and_right(void)
{
    for (int i = 0; i < EDML_JOINTS; i++) {
        int sum = 0;
        for (int j = 0; j < EDML_JOINTS; j++) {
            sum += edml_default_imputation.weight[i][j];
            TEST_ASSERT_EQUAL_INT(
                edml_default_imputation.weight[i][j],
                edml_default_imputation.weight[edml_mirror_joint[i]][edml_mirror_joint[j]]);
        }
        TEST_ASSERT_EQUAL_INT(EDML_IMPUTATION_ONE, sum);
        TEST_ASSERT_EQUAL_INT(0, edml_default_imputation.weight[i][i]);
    }
}

static void up_to_nine_joints_are_guessed(void)
{
    someone();
    for (int j = 5; j < EDML_JOINTS; j++) in[j].c = 0;
    memset(&image, 0, sizeof image);
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_body_frame(&image, in, 1, imputation));
    TEST_ASSERT_TRUE(all_finite(&image, 2 * EDML_JOINTS + 2));
    in[EDML_R_WRIST].c = 0;
    again = image;
    TEST_ASSERT_EQUAL_INT(EDML_ERR_TOO_FEW_JOINTS, edml_body_frame(&image, in, 1, imputation));
    TEST_ASSERT_SAME_BYTES(again, image);
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_body_frame(&image, in, 1, NULL)); /* four, and no guess */
}

/* Two joints that are each expected where the other one is. */
static void an_imputation_that_goes_round_in_a_circle_is_refused(void)
{
    edml_imputation circle = edml_default_imputation;
    memset(circle.weight[EDML_R_ELBOW], 0, sizeof circle.weight[0]);
    memset(circle.weight[EDML_R_WRIST], 0, sizeof circle.weight[0]);
    circle.weight[EDML_R_ELBOW][EDML_R_WRIST] = EDML_IMPUTATION_ONE;
    circle.weight[EDML_R_WRIST][EDML_R_ELBOW] = EDML_IMPUTATION_ONE;
    someone();
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_body_frame(&image, in, FEWEST, &circle));
    in[EDML_R_ELBOW].c = in[EDML_R_WRIST].c = 0;
    memset(&image, 0xA5, sizeof image);
    again = image;
    TEST_ASSERT_EQUAL_INT(EDML_ERR_DEGENERATE, edml_body_frame(&image, in, FEWEST, &circle));
    TEST_ASSERT_SAME_BYTES(again, image);
}

/* ---- Invariance ------------------------------------------------------------------------------ */

/* Upside down, lying, sideways, and anything between: the same, but for rounding of the pixels. */
static void however_the_camera_is_rolled_the_image_is_the_same(void)
{
    rng r = rng_seed(5);
    float worst = 0, worst_down = 0;
    for (int n = 0; n < 200; n++) {
        const double degrees = n % 4 ? (double)uniform(&r, -180, 180) : 90.0 * (n / 4 % 4);
        whole_pixels(&r);
        hide(n % 5, &r);
        check_run(&image);
        roll(degrees);
        check_run(&again);
        const double angle = degrees * 3.14159265358979 / 180, c = cos(angle), s = sin(angle);
        const edml_image_point was = image.down;
        image.down.u = (float)(c * (double)was.u - s * (double)was.v);
        image.down.v = (float)(s * (double)was.u + c * (double)was.v);
        worst = worse(worst, worst_difference(&image, &again));
        worst_down = worse(worst_down, turned_by(&image, &again));
        TEST_ASSERT_EQUAL_INT(image.seen, again.seen);
    }
    printf("body frame: rolled, worst %.2g, down %.2g\n", (double)worst, (double)worst_down);
    TEST_ASSERT_ERROR_UP_TO(FRAME_ROLLED_TOLERANCE, worst);
    TEST_ASSERT_ERROR_UP_TO(FRAME_ROLLED_TOLERANCE, worst_down);
}

/* As section 3.1 has it: the image's own axes. */
static void without_an_imputation_a_roll_is_seen(void)
{
    someone();
    TEST_ASSERT_EQUAL_INT(EDML_OK, run_upright(&image));
    roll(180);
    TEST_ASSERT_EQUAL_INT(EDML_OK, run_upright(&again));
    for (int j = 0; j < EDML_JOINTS; j++) {
        TEST_ASSERT_FLOAT_WITHIN(FRAME_ROLLED_TOLERANCE, -image.at[j].u, again.at[j].u);
        TEST_ASSERT_FLOAT_WITHIN(FRAME_ROLLED_TOLERANCE, -image.at[j].v, again.at[j].v);
    }
    TEST_ASSERT_TRUE(again.down.u == 0 && again.down.v == 1);
}

static void check_same_after(float ax, float bx, float ay, float by)
{
    rng r = rng_seed(6);
    for (int n = 0; n < 20; n++) {
        whole_pixels(&r);
        hide(n % 4, &r);
        check_run(&image);
        map(ax, bx, ay, by);
        check_run(&again);
        TEST_ASSERT_SAME_BYTES(image, again);
    }
}

static void moving_the_image_changes_no_bit(void)
{
    check_same_after(1, 1234, 1, -777);
#ifndef EDML_TEST_Q24
    check_same_after(1, 100000, 1, 300000); /* pixels are still whole in float32 */
#endif
}

static void scaling_the_image_by_a_power_of_two_changes_no_bit(void)
{
    check_same_after(0.125F, 0, 0.125F, 0);
#ifndef EDML_TEST_Q24
    check_same_after(ldexpf(1, 100), 0, ldexpf(1, 100), 0);
    check_same_after(ldexpf(1, -100), 0, ldexpf(1, -100), 0);
#endif
}

static void turning_the_image_upside_down_turns_down(void)
{
    rng r = rng_seed(7);
    for (int n = 0; n < 20; n++) {
        whole_pixels(&r);
        hide(n % 4, &r);
        check_run(&image);
        map(-1, 900, -1, 800);
        check_run(&again);
        TEST_ASSERT_ERROR_UP_TO(FRAME_TOLERANCE, worst_difference(&image, &again));
        TEST_ASSERT_FLOAT_WITHIN(FRAME_TOLERANCE, -image.down.u, again.down.u);
        TEST_ASSERT_FLOAT_WITHIN(FRAME_TOLERANCE, -image.down.v, again.down.v);
    }
}

static void scaling_the_image_changes_rounding_only(void)
{
    rng r = rng_seed(8);
    for (int n = 0; n < 50; n++) {
        whole_pixels(&r);
        check_run(&image);
        const float scale = uniform(&r, FRAME_LEAST_SCALE, FRAME_LARGEST_SCALE);
        map(scale, 0, scale, 0);
        check_run(&again);
        TEST_ASSERT_ERROR_UP_TO(FRAME_SCALED_TOLERANCE, worst_difference(&image, &again));
    }
}

/* ---- Refusals -------------------------------------------------------------------------------- */

/* And the output is left alone. */
static void check(edml_status expected)
{
    memset(&image, 0xA5, sizeof image);
    again = image;
    TEST_ASSERT_EQUAL_INT(expected, run(&image));
    if (expected != EDML_OK) TEST_ASSERT_SAME_BYTES(again, image);
    image = again;
    TEST_ASSERT_EQUAL_INT(expected, run_upright(&image));
    if (expected != EDML_OK) TEST_ASSERT_SAME_BYTES(again, image);
}

static void not_finite_is_refused_in_each_member_of_each_joint(void)
{
    static const float bad[] = {NAN, INFINITY, -INFINITY};
    for (int j = 0; j < EDML_JOINTS; j++) {
        for (int n = 0; n < FRAME_FLOAT_MEMBERS * 3; n++) {
            someone();
            float *member = n / 3 == 0 ? &in[j].x : n / 3 == 1 ? &in[j].y : &in[j].c;
            *member = bad[n % 3];
            check(EDML_ERR_NOT_FINITE);
        }
    }
}

static void fewer_than_the_fewest_joints_are_refused(void)
{
    someone();
    for (int j = 0; j < EDML_JOINTS - FEWEST; j++) in[2 + j].c = 0;
    check(EDML_OK);
    in[EDML_HEAD].c = 0;
    check(EDML_ERR_TOO_FEW_JOINTS);
    for (int j = 0; j < EDML_JOINTS; j++) in[j].c = -0.0F;
    check(EDML_ERR_TOO_FEW_JOINTS);
}

static void equal_points_are_refused(void)
{
    someone();
    map(0, 320, 0, 240);
    check(EDML_ERR_DEGENERATE);
    map(0, 0, 0, 0);
    check(EDML_ERR_DEGENERATE);
}

static void points_on_a_line_are_refused(void)
{
    someone();
    map(1, 0, 0, 240);
    check(EDML_ERR_DEGENERATE);
    for (int slope = -4; slope <= 4; slope++) { /* vertical at 0 */
        someone();
        for (int j = 0; j < EDML_JOINTS; j++) in[j].x = (float)slope * 0.5F * in[j].y;
        check(EDML_ERR_DEGENERATE);
    }
}

static void points_nearly_on_a_line_are_refused_and_a_narrow_person_is_not(void)
{
    for (int turned = 0; turned < 2; turned++) {
        someone();
        map(1.0F / 100, 0, 1, 0); /* a person's spread is about three times as high as wide */
        if (turned) roll(70);
        check(EDML_ERR_DEGENERATE);
        someone();
        map(1.0F / 8, 0, 1, 0);
        if (turned) roll(70);
        check(EDML_OK);
    }
}

/* A joint beside a line of the others, at which the determinant of the spread is 2^-14 of its trace's square. */
static double thinness(int joint, double aside)
{
    double u = 0, v = 0, uu = 0, uv = 0, vv = 0;
    for (int j = 0; j < EDML_JOINTS; j++) {
        const double du = (j == joint) * aside - aside / EDML_JOINTS, dv = j - (EDML_JOINTS - 1) / 2.0;
        u += du;
        v += dv;
        uu += du * du;
        uv += du * dv;
        vv += dv * dv;
    }
    TEST_ASSERT_TRUE(fabs(u) < 1e-9 && fabs(v) < 1e-9);
    return (uu * vv - uv * uv) / ((uu + vv) * (uu + vv));
}

static void a_joint_beside_a_line_counts_by_how_far_it_is(void)
{
    for (int joint = 0; joint < EDML_JOINTS; joint++) {
        double aside = 0.01; /* of the way from joint to joint */
        while (thinness(joint, aside) < ldexp(1, -14)) aside *= 1.001;
        for (int outside = 0; outside < 2; outside++) {
            for (int j = 0; j < EDML_JOINTS; j++) {
                in[j].x = 320 + 32 * (float)((j == joint) * aside * (outside ? 1.02 : 0.98));
                in[j].y = (float)(100 + 32 * j);
                in[j].c = 1;
            }
            TEST_ASSERT_EQUAL_INT(outside ? EDML_OK : EDML_ERR_DEGENERATE, run_upright(&image));
        }
    }
}

static void a_flat_and_wide_person_is_framed(void)
{
    someone();
    map(1, -500, 1, 0);
    map(20, 500, 1, 0);
    check(EDML_OK);
}

#ifndef EDML_TEST_Q24 /* ---- The ends of float's range ---- */

static void a_person_lost_in_the_rounding_of_far_coordinates_is_refused(void)
{
    static const float far[][2] = {{1e6F, 0}, {0, -1e6F}, {-1e6F, 0}, {0, 1e6F}};
    for (int n = 0; n < 4; n++) {
        someone(); /* 330 pixels high */
        map(1, far[n][0], 1, far[n][1]);
        check(EDML_ERR_DEGENERATE);
    }
    someone();
    map(1, 1e5F, 1, 1e5F);
    check(EDML_OK);
}

/* Where floats lose bits to being small. */
static void a_person_smaller_than_the_least_number_with_all_its_bits_is_refused(void)
{
    someone();
    map(0x1p-120F, 0, 0x1p-120F, 0);
    check(EDML_OK);
    map(0x1p-34F, 0, 0x1p-34F, 0);
    check(EDML_ERR_DEGENERATE);
}

static void coordinates_whose_differences_overflow_are_framed(void)
{
    someone();
    in[EDML_L_WRIST].x = in[EDML_L_WRIST].y = 3e38F;
    in[EDML_R_WRIST].x = -3e38F;
    TEST_ASSERT_EQUAL_INT(EDML_OK, run_upright(&image)); /* the others are a point between the two wrists */
    TEST_ASSERT_FLOAT_WITHIN(1e-5F, 4, image.at[EDML_L_WRIST].u - image.at[EDML_R_WRIST].u);
    TEST_ASSERT_FLOAT_WITHIN(1e-5F, 2, image.at[EDML_L_WRIST].v - image.at[EDML_R_WRIST].v);
}

/* However large or small: a status in range, and finite values with EDML_OK. */
static void extreme_coordinates_give_finite_values_or_a_refusal(void)
{
    static const float size[] = {1e30F, 3e35F, 1e-30F, FLT_MIN, 1e-40F, 1e-43F};
    for (unsigned n = 0; n < sizeof size / sizeof *size; n++) {
        someone();
        map(size[n], 0, size[n], 0);
        const edml_status status = run(&image);
        TEST_ASSERT_TRUE(status == EDML_OK || status == EDML_ERR_DEGENERATE);
        if (status != EDML_OK) continue;
        for (int k = 0; k < EDML_JOINTS; k++)
            TEST_ASSERT_TRUE(fabsf(image.at[k].u) <= 3.9F && fabsf(image.at[k].v) <= 3.9F);
    }
}

#else

static void people_of_less_than_an_eighth_of_a_pixel_are_refused(void)
{
    for (int turned = 0; turned < 2; turned++) {
        someone();
        if (turned) roll(90);
        map(1, -500, 1, -400); /* 330 pixels */
        map(1.0F / 2048, 0, 1.0F / 2048, 0);
        check(EDML_OK);
        map(0.5F, 0, 0.5F, 0);
        check(EDML_ERR_DEGENERATE);
    }
}

#endif

static void null_is_refused(void)
{
    someone();
    TEST_ASSERT_EQUAL_INT(EDML_ERR_ARGUMENT, edml_body_frame(NULL, in, FEWEST, NULL));
    TEST_ASSERT_EQUAL_INT(EDML_ERR_ARGUMENT, edml_body_frame(&image, NULL, FEWEST, NULL));
}

static void a_joint_alone_is_refused(void)
{
    for (int alone = 0; alone < EDML_JOINTS; alone++) {
        someone();
        for (int j = 0; j < EDML_JOINTS; j++) in[j].c = j == alone;
        TEST_ASSERT_EQUAL_INT(EDML_ERR_DEGENERATE, edml_body_frame(&image, in, 1, NULL));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_frame_is_as_defined);
    RUN_TEST(what_is_wide_is_scaled_by_its_width);
    RUN_TEST(joints_one_above_the_other_at_the_extremes_are_exactly_2_apart);
    RUN_TEST(down_is_a_unit_vector_and_the_hips_are_below_the_shoulders);
    RUN_TEST(without_an_axis_the_image_is_not_turned);
    RUN_TEST(guesses_end_at_the_border);
    RUN_TEST(swapping_all_joints_of_right_and_left_in_a_mirror_mirrors_the_image);
    RUN_TEST(without_an_imputation_missing_joints_are_at_zero_and_others_stay);
    RUN_TEST(a_missing_joints_coordinates_do_not_matter);
    RUN_TEST(how_confident_does_not_matter);
    RUN_TEST(weights_of_a_guess_add_up_to_one_and_are_the_same_for_left_and_right);
    RUN_TEST(up_to_nine_joints_are_guessed);
    RUN_TEST(an_imputation_that_goes_round_in_a_circle_is_refused);
    RUN_TEST(however_the_camera_is_rolled_the_image_is_the_same);
    RUN_TEST(without_an_imputation_a_roll_is_seen);
    RUN_TEST(moving_the_image_changes_no_bit);
    RUN_TEST(scaling_the_image_by_a_power_of_two_changes_no_bit);
    RUN_TEST(turning_the_image_upside_down_turns_down);
    RUN_TEST(scaling_the_image_changes_rounding_only);
    RUN_TEST(not_finite_is_refused_in_each_member_of_each_joint);
    RUN_TEST(fewer_than_the_fewest_joints_are_refused);
    RUN_TEST(equal_points_are_refused);
    RUN_TEST(a_joint_alone_is_refused);
    RUN_TEST(points_on_a_line_are_refused);
    RUN_TEST(points_nearly_on_a_line_are_refused_and_a_narrow_person_is_not);
    RUN_TEST(a_joint_beside_a_line_counts_by_how_far_it_is);
    RUN_TEST(a_flat_and_wide_person_is_framed);
#ifndef EDML_TEST_Q24
    RUN_TEST(a_person_lost_in_the_rounding_of_far_coordinates_is_refused);
    RUN_TEST(a_person_smaller_than_the_least_number_with_all_its_bits_is_refused);
    RUN_TEST(coordinates_whose_differences_overflow_are_framed);
    RUN_TEST(extreme_coordinates_give_finite_values_or_a_refusal);
#else
    RUN_TEST(people_of_less_than_an_eighth_of_a_pixel_are_refused);
#endif
    RUN_TEST(null_is_refused);
    return UNITY_END();
}
