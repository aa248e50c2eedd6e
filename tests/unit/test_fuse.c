/* lift/fuse.h: the weighted mean of a pose and its image.
 *
 * SPDX-License-Identifier: MIT
 */
#include "as_float.h"
#include "network/model.h"

static edml_point person[EDML_JOINTS], x[EDML_JOINTS], y[EDML_JOINTS];
static edml_keypoint in[EDML_JOINTS];
static edml_model model;

static edml_number number(double value)
{
    const edml_number both = {(float)value, (int32_t)(value * (1 << 24) + 0.5)};
    return both;
}

/* nearness: 1 / distance */
static void set_model(double weight, double misfit, double nearness)
{
    model = edml_fconn_f32;
    model.fusion[0] = number(weight * misfit * misfit);
    model.fusion[1] = number(misfit * misfit);
    model.fusion[2] = number(nearness);
}

/* A person, rooted, and a photograph of where joints really are, `noise` metres off. */
static void someone(rng *r, float noise)
{
    random_human(r, person);
    root_at_mid_hip(person);
    for (int j = 0; j < EDML_JOINTS; j++) {
        y[j] = person[j];
        y[j].x += noise * gauss(r);
        y[j].y += noise * gauss(r);
    }
    photograph(in, y);
    memcpy(x, person, sizeof x);
}

static edml_point mean_of(const edml_point p[EDML_JOINTS], uint16_t seen)
{
    edml_point sum = {0, 0, 0};
    int count = 0;
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (!(seen >> j & 1)) continue;
        sum.x += p[j].x;
        sum.y += p[j].y;
        sum.z += p[j].z;
        count++;
    }
    const edml_point mean = {sum.x / (float)count, sum.y / (float)count, sum.z / (float)count};
    return mean;
}

/* Mean square in m^2 of what the joints across the axis are off the image, at its best scale. */
static double disagreement(const edml_point p[EDML_JOINTS], uint16_t seen)
{
    edml_point image[EDML_JOINTS];
    for (int j = 0; j < EDML_JOINTS; j++) {
        image[j].x = in[j].x;
        image[j].y = in[j].y;
        image[j].z = 0;
    }
    const edml_point at = mean_of(image, seen), middle = mean_of(p, seen);
    double xx = 0, xu = 0, uu = 0;
    int count = 0;
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (!(seen >> j & 1)) continue;
        const double px = (double)(p[j].x - middle.x), py = (double)(p[j].y - middle.y);
        const double u = (double)(image[j].x - at.x), v = (double)(image[j].y - at.y);
        xx += px * px + py * py;
        xu += px * u + py * v;
        uu += u * u + v * v;
        count++;
    }
    return (xx - xu * xu / uu) / count;
}

/* ---- What it does ---------------------------------------------------------------------------- */

static void a_pose_that_agrees_stays(void)
{
    rng r = rng_seed(61);
    set_model(0.9, 0.05, 0);
    for (int n = 0; n < 100; n++) {
        someone(&r, 0);
        edml_fuse(x, in, ALL_SEEN, &model);
        TEST_ASSERT_ERROR_UP_TO(FUSE_TOLERANCE, worst_joint_error(x, person));
    }
}

/* Seen from 4 m, a joint 0.4 m nearer is a tenth larger; that is no disagreement. */
static void nor_does_perspective_move_it(void)
{
    rng r = rng_seed(62);
    set_model(0.9, 0.05, 0.25);
    for (int n = 0; n < 100; n++) {
        someone(&r, 0);
        edml_point shift = {0, 0, 0}; /* that puts the middle of the image on the camera's axis */
        const edml_point middle = mean_of(person, ALL_SEEN);
        for (int step = 0; step < 20; step++) {
            float low_x = 9, low_y = 9, high_x = -9, high_y = -9;
            for (int j = 0; j < EDML_JOINTS; j++) {
                const float depth = 1 + (person[j].z - middle.z) / 4;
                y[j].x = (person[j].x + shift.x) / depth;
                y[j].y = (person[j].y + shift.y) / depth;
                low_x = fminf(low_x, y[j].x);
                low_y = fminf(low_y, y[j].y);
                high_x = fmaxf(high_x, y[j].x);
                high_y = fmaxf(high_y, y[j].y);
            }
            shift.x -= (low_x + high_x) / 2;
            shift.y -= (low_y + high_y) / 2;
        }
        photograph(in, y);
        edml_fuse(x, in, ALL_SEEN, &model);
        TEST_ASSERT_ERROR_UP_TO(FUSE_TOLERANCE, worst_joint_error(x, person));
    }
}

static void what_disagrees_shrinks_by_the_weight(void)
{
    rng r = rng_seed(63);
    const double weight = 0.75, misfit = 0.08;
    set_model(weight, misfit, 0);
    for (int n = 0; n < 200; n++) {
        const uint16_t seen = n % 2 ? ALL_SEEN : ALL_SEEN & ~(1 << EDML_L_KNEE | 1 << EDML_HEAD);
        someone(&r, 0.01F * (float)(n % 20));
        for (int j = 0; j < EDML_JOINTS; j++)
            if (!(seen >> j & 1)) in[j].x = in[j].y = in[j].c = 0;
        const double before = disagreement(x, seen);
        edml_fuse(x, in, seen, &model);
        const double left = 1 - weight / (1 + before / (misfit * misfit));
        TEST_ASSERT_ERROR_UP_TO(FUSE_TOLERANCE, (float)(sqrt(disagreement(x, seen)) - left * sqrt(before)));
    }
}

static void depths_stay(void)
{
    rng r = rng_seed(64);
    set_model(1, 0.3, 0.2);
    for (int n = 0; n < 100; n++) {
        someone(&r, 0.1F);
        edml_fuse(x, in, ALL_SEEN, &model);
        for (int j = 0; j < EDML_JOINTS; j++) TEST_ASSERT_FLOAT_WITHIN(FUSE_TOLERANCE, person[j].z, x[j].z);
    }
}

static void without_a_weight_nothing_moves(void)
{
    rng r = rng_seed(65);
    set_model(0, 1, 0);
    for (int n = 0; n < 100; n++) {
        someone(&r, 0.1F);
        edml_fuse(x, in, ALL_SEEN, &model);
        TEST_ASSERT_ERROR_UP_TO(ROUNDING, worst_joint_error(x, person));
    }
}

static void joints_that_were_not_seen_stay_where_they_are(void)
{
    rng r = rng_seed(66);
    set_model(1, 0.3, 0.2);
    for (int n = 0; n < 100; n++) {
        someone(&r, 0.1F);
        in[EDML_R_WRIST].x = in[EDML_L_ANKLE].y = NAN;
        edml_fuse(x, in, ALL_SEEN & ~(1 << EDML_R_WRIST) & ~(1 << EDML_L_ANKLE), &model);
        TEST_ASSERT_TRUE(all_finite(x, 3 * EDML_JOINTS));
        const edml_point a = person[EDML_R_WRIST], b = person[EDML_L_ANKLE];
        TEST_ASSERT_FLOAT_WITHIN(FUSE_TOLERANCE, a.x - b.x, x[EDML_R_WRIST].x - x[EDML_L_ANKLE].x);
        TEST_ASSERT_FLOAT_WITHIN(FUSE_TOLERANCE, a.y - b.y, x[EDML_R_WRIST].y - x[EDML_L_ANKLE].y);
    }
}

static void mid_hip_is_the_origin(void)
{
    rng r = rng_seed(67);
    set_model(0.9, 0.3, 0.2);
    for (int n = 0; n < 50; n++) {
        someone(&r, 0.1F);
        edml_fuse(x, in, ALL_SEEN, &model);
        TEST_ASSERT_ERROR_UP_TO(ROUNDING, x[EDML_R_HIP].x + x[EDML_L_HIP].x);
        TEST_ASSERT_ERROR_UP_TO(ROUNDING, x[EDML_R_HIP].y + x[EDML_L_HIP].y);
        TEST_ASSERT_ERROR_UP_TO(ROUNDING, x[EDML_R_HIP].z + x[EDML_L_HIP].z);
    }
}

static void a_mirrored_image_mirrors_the_pose(void)
{
    rng r = rng_seed(68);
    set_model(0.9, 0.1, 0.2);
    for (int n = 0; n < 50; n++) {
        someone(&r, 0.05F);
        for (int j = 0; j < EDML_JOINTS; j++) {
            y[j] = x[j];
            y[j].x = -x[j].x;
        }
        edml_fuse(x, in, ALL_SEEN, &model);
        for (int j = 0; j < EDML_JOINTS; j++) in[j].x = -in[j].x;
        edml_fuse(y, in, ALL_SEEN, &model);
        for (int j = 0; j < EDML_JOINTS; j++) y[j].x = -y[j].x;
        TEST_ASSERT_ERROR_UP_TO(FUSE_TOLERANCE, worst_joint_error(x, y));
    }
}

/* ---- Where there is nothing to go by ----------------------------------------------------------- */

static void check_kept(void)
{
    memcpy(x, person, sizeof x);
    edml_fuse(x, in, ALL_SEEN, &model);
    TEST_ASSERT_ERROR_UP_TO(ROUNDING, worst_joint_error(x, person));
}

static void images_of_no_size_or_upside_down_leave_the_pose(void)
{
    rng r = rng_seed(69);
    set_model(1, 1, 0);
    someone(&r, 0);
    for (int j = 0; j < EDML_JOINTS; j++) {
        in[j].x = 1000 - in[j].x;
        in[j].y = 1000 - in[j].y;
    }
    check_kept();
    for (int j = 0; j < EDML_JOINTS; j++) in[j].y = 100;
    check_kept();
    for (int j = 0; j < EDML_JOINTS; j++) in[j].x = 100;
    check_kept();
}

static void equal_points_stay_at_the_origin(void)
{
    rng r = rng_seed(70);
    set_model(1, 0.01, 0.3);
    someone(&r, 0);
    equal_points(x, 0, 0, 0);
    edml_fuse(x, in, ALL_SEEN, &model);
    for (int j = 0; j < EDML_JOINTS; j++) TEST_ASSERT_TRUE(x[j].x == 0 && x[j].y == 0 && x[j].z == 0);
}

static void no_joints_leave_the_pose_and_bits_beyond_them_do_not_count(void)
{
    rng r = rng_seed(71);
    set_model(1, 0.01, 0.3);
    someone(&r, 0.05F);
    memcpy(x, person, sizeof x);
    edml_fuse(x, in, 0, &model);
    TEST_ASSERT_ERROR_UP_TO(ROUNDING, worst_joint_error(x, person));
    memcpy(y, x, sizeof y);
    edml_fuse(x, in, ALL_SEEN, &model);
    edml_fuse(y, in, 0xFFFF, &model);
    TEST_ASSERT_EQUAL_MEMORY(x, y, sizeof x);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_pose_that_agrees_stays);
    RUN_TEST(nor_does_perspective_move_it);
    RUN_TEST(what_disagrees_shrinks_by_the_weight);
    RUN_TEST(depths_stay);
    RUN_TEST(without_a_weight_nothing_moves);
    RUN_TEST(joints_that_were_not_seen_stay_where_they_are);
    RUN_TEST(mid_hip_is_the_origin);
    RUN_TEST(a_mirrored_image_mirrors_the_pose);
    RUN_TEST(images_of_no_size_or_upside_down_leave_the_pose);
    RUN_TEST(equal_points_stay_at_the_origin);
    RUN_TEST(no_joints_leave_the_pose_and_bits_beyond_them_do_not_count);
    return UNITY_END();
}
