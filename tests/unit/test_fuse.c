/* lift/fuse.h: the weighted mean of points and their image.
 *
 * SPDX-License-Identifier: MIT
 */
#include "as_float.h"
#include "network/model.h"

static edml_point person[EDML_JOINTS], x[EDML_JOINTS], y[EDML_JOINTS];
static edml_image image;
static float share[EDML_JOINTS];
static edml_model model;

static edml_number number(double value)
{
    const edml_number both = {(float)value, (int32_t)(value * (1 << 24) + 0.5)};
    return both;
}

/* The same share for each joint.  nearness: 1 / distance */
static void set_model(float all, double misfit, double nearness)
{
    model = edml_direct_f32;
    model.fusion[FUSION_SHARE] = number(0.5); /* is of models without gates, and not for this stage */
    model.fusion[FUSION_SQUARE] = number(misfit * misfit);
    model.fusion[FUSION_NEARNESS] = number(nearness);
    for (int j = 0; j < EDML_JOINTS; j++) share[j] = all;
}

static float run(edml_point points[EDML_JOINTS]) { return edml_fuse(points, &image, share, &model); }

/* A person about mid-hip, and an image of where joints really are, `noise` metres off. */
static void someone(rng *r, float noise)
{
    random_human(r, person);
    root_at_mid_hip(person);
    for (int j = 0; j < EDML_JOINTS; j++) {
        y[j] = person[j];
        y[j].x += noise * gauss(r);
        y[j].y += noise * gauss(r);
    }
    draw_image(&image, y, ALL_SEEN);
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

/* Where the image has the joints, brought to their mean depth. */
static void image_points(edml_point out[EDML_JOINTS], const edml_point p[EDML_JOINTS], uint16_t seen)
{
    const float middle = mean_of(p, seen).z;
    for (int j = 0; j < EDML_JOINTS; j++) {
        const float depth = 1 + model.fusion[FUSION_NEARNESS].f32 * (p[j].z - middle);
        out[j].x = image.at[j].u * depth;
        out[j].y = image.at[j].v * depth;
        out[j].z = 0;
    }
}

/* Mean square in m^2 of what the joints across the axis are off the image, at its best scale. */
static double disagreement(const edml_point p[EDML_JOINTS], uint16_t seen)
{
    edml_point flat[EDML_JOINTS];
    image_points(flat, p, seen);
    const edml_point at = mean_of(flat, seen), middle = mean_of(p, seen);
    double xx = 0, xu = 0, uu = 0;
    int count = 0;
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (!(seen >> j & 1)) continue;
        const double px = (double)(p[j].x - middle.x), py = (double)(p[j].y - middle.y);
        const double u = (double)(flat[j].x - at.x), v = (double)(flat[j].y - at.y);
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
    set_model(0.9F, 0.05, 0);
    for (int n = 0; n < 100; n++) {
        someone(&r, 0);
        TEST_ASSERT_ERROR_UP_TO(FUSE_MISFIT_TOLERANCE, run(x));
        TEST_ASSERT_ERROR_UP_TO(FUSE_TOLERANCE, worst_joint_error(x, person));
    }
}

/* Seen from 4 m, a joint 0.4 m nearer is a tenth larger; that is no disagreement. */
static void nor_does_perspective_move_it(void)
{
    rng r = rng_seed(62);
    set_model(0.9F, 0.05, 0.25);
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
        draw_image(&image, y, ALL_SEEN);
        TEST_ASSERT_ERROR_UP_TO(FUSE_MISFIT_TOLERANCE, run(x));
        TEST_ASSERT_ERROR_UP_TO(FUSE_TOLERANCE, worst_joint_error(x, person));
    }
}

static void what_disagrees_shrinks_by_the_weight(void)
{
    rng r = rng_seed(63);
    const double weight = 0.75, misfit = 0.08;
    set_model(0.75F, misfit, 0);
    for (int n = 0; n < 200; n++) {
        const uint16_t seen = n % 2 ? ALL_SEEN : ALL_SEEN & ~(1 << EDML_L_KNEE | 1 << EDML_HEAD);
        someone(&r, 0.01F * (float)(n % 20));
        draw_image(&image, y, seen);
        const double before = disagreement(x, seen);
        TEST_ASSERT_FLOAT_WITHIN(FUSE_MISFIT_TOLERANCE, (float)sqrt(before), run(x));
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
        run(x);
        for (int j = 0; j < EDML_JOINTS; j++) TEST_ASSERT_FLOAT_WITHIN(FUSE_TOLERANCE, person[j].z, x[j].z);
    }
}

static void without_a_share_nothing_moves(void)
{
    rng r = rng_seed(65);
    set_model(0, 1, 0);
    for (int n = 0; n < 100; n++) {
        someone(&r, 0.1F);
        TEST_ASSERT_FLOAT_WITHIN(FUSE_MISFIT_TOLERANCE, (float)sqrt(disagreement(person, ALL_SEEN)),
                                 run(x));
        TEST_ASSERT_ERROR_UP_TO(FUSE_KEPT, worst_joint_error(x, person));
    }
}

/* To where the image has it, at its best scale. */
static void a_share_of_one_moves_a_joint_to_the_image_and_others_stay(void)
{
    rng r = rng_seed(72);
    for (int n = 0; n < 100; n++) {
        edml_point flat[EDML_JOINTS];
        set_model(0, 8, n % 2 ? 0.25 : 0);
        someone(&r, 0.1F);
        const int moved = n % EDML_JOINTS;
        share[moved] = 1;
        image_points(flat, person, ALL_SEEN);
        const edml_point at = mean_of(flat, ALL_SEEN), middle = mean_of(person, ALL_SEEN);
        double xu = 0, uu = 0;
        for (int j = 0; j < EDML_JOINTS; j++) {
            const double u = (double)(flat[j].x - at.x), v = (double)(flat[j].y - at.y);
            xu += u * (double)(person[j].x - middle.x) + v * (double)(person[j].y - middle.y);
            uu += u * u + v * v;
        }
        run(x);
        const float scale = (float)(xu / uu), weight = (float)(64 / (64 + disagreement(person, ALL_SEEN)));
        edml_point expected = person[moved];
        expected.x += weight * (middle.x + scale * (flat[moved].x - at.x) - expected.x);
        expected.y += weight * (middle.y + scale * (flat[moved].y - at.y) - expected.y);
        TEST_ASSERT_ERROR_UP_TO(FUSE_TOLERANCE, (float)distance_between(expected, x[moved]));
        x[moved] = person[moved];
        TEST_ASSERT_ERROR_UP_TO(FUSE_KEPT, worst_joint_error(x, person));
    }
}

static void joints_that_were_not_seen_stay_where_they_are(void)
{
    rng r = rng_seed(66);
    set_model(1, 0.3, 0.2);
    for (int n = 0; n < 100; n++) {
        someone(&r, 0.1F);
        image.at[EDML_R_WRIST].u = image.at[EDML_L_ANKLE].v = share[EDML_L_ANKLE] = NAN;
        image.seen = ALL_SEEN & ~(1 << EDML_R_WRIST) & ~(1 << EDML_L_ANKLE);
        TEST_ASSERT_TRUE(run(x) > 0);
        TEST_ASSERT_TRUE(all_finite(x, 3 * EDML_JOINTS));
        TEST_ASSERT_ERROR_UP_TO(FUSE_KEPT, (float)distance_between(person[EDML_R_WRIST], x[EDML_R_WRIST]));
        TEST_ASSERT_ERROR_UP_TO(FUSE_KEPT, (float)distance_between(person[EDML_L_ANKLE], x[EDML_L_ANKLE]));
    }
}

/* With equal shares: what the points are about is not changed, wherever the image is. */
static void the_mean_of_the_seen_joints_stays(void)
{
    rng r = rng_seed(67);
    set_model(0.9F, 0.3, 0.2);
    for (int n = 0; n < 50; n++) {
        someone(&r, 0.1F);
        if (n % 2) image.seen = ALL_SEEN & ~(1 << EDML_R_WRIST) & ~(1 << EDML_HEAD);
        for (int j = 0; j < EDML_JOINTS; j++) {
            image.at[j].u += 0.5F;
            image.at[j].v -= 0.25F;
        }
        const edml_point was = mean_of(person, image.seen);
        run(x);
        TEST_ASSERT_ERROR_UP_TO(ROUNDING, (float)distance_between(was, mean_of(x, image.seen)));
    }
}

static void a_mirrored_image_mirrors_the_pose(void)
{
    rng r = rng_seed(68);
    set_model(0.9F, 0.1, 0.2);
    for (int n = 0; n < 50; n++) {
        someone(&r, 0.05F);
        for (int j = 0; j < EDML_JOINTS; j++) {
            y[j] = x[j];
            y[j].x = -x[j].x;
        }
        const float misfit = run(x);
        for (int j = 0; j < EDML_JOINTS; j++) image.at[j].u = -image.at[j].u;
        TEST_ASSERT_FLOAT_WITHIN(FUSE_MISFIT_TOLERANCE, misfit, run(y));
        for (int j = 0; j < EDML_JOINTS; j++) y[j].x = -y[j].x;
        TEST_ASSERT_ERROR_UP_TO(FUSE_TOLERANCE, worst_joint_error(x, y));
    }
}

/* ---- Where there is nothing to go by ----------------------------------------------------------- */

/* The misfit is then all of the points' extent across the axis. */
static void check_kept(void)
{
    const edml_point middle = mean_of(person, ALL_SEEN);
    double square = 0;
    for (int j = 0; j < EDML_JOINTS; j++) {
        const double px = (double)(person[j].x - middle.x), py = (double)(person[j].y - middle.y);
        square += (px * px + py * py) / EDML_JOINTS;
    }
    memcpy(x, person, sizeof x);
    TEST_ASSERT_FLOAT_WITHIN(FUSE_TOLERANCE, (float)sqrt(square), run(x));
    TEST_ASSERT_ERROR_UP_TO(FUSE_KEPT, worst_joint_error(x, person));
}

static void images_of_no_size_or_upside_down_leave_the_pose(void)
{
    rng r = rng_seed(69);
    set_model(1, 1, 0);
    someone(&r, 0);
    for (int j = 0; j < EDML_JOINTS; j++) {
        image.at[j].u = 0.5F - image.at[j].u;
        image.at[j].v = 0.5F - image.at[j].v;
    }
    check_kept();
    for (int j = 0; j < EDML_JOINTS; j++) image.at[j].v = 0.25F;
    check_kept();
    for (int j = 0; j < EDML_JOINTS; j++) image.at[j].u = 0.25F;
    check_kept();
}

static void equal_points_stay_at_the_origin(void)
{
    rng r = rng_seed(70);
    set_model(1, 0.01, 0.3);
    someone(&r, 0);
    equal_points(x, 0, 0, 0);
    TEST_ASSERT_TRUE(run(x) == 0);
    for (int j = 0; j < EDML_JOINTS; j++) TEST_ASSERT_TRUE(x[j].x == 0 && x[j].y == 0 && x[j].z == 0);
}

static void no_joints_leave_the_pose_and_bits_beyond_them_do_not_count(void)
{
    rng r = rng_seed(71);
    set_model(1, 0.01, 0.3);
    someone(&r, 0.05F);
    memcpy(x, person, sizeof x);
    image.seen = 0;
    TEST_ASSERT_TRUE(run(x) == 0);
    image.seen = (uint16_t)~ALL_SEEN;
    TEST_ASSERT_TRUE(run(x) == 0);
    TEST_ASSERT_ERROR_UP_TO(FUSE_KEPT, worst_joint_error(x, person));
    memcpy(y, x, sizeof y);
    image.seen = ALL_SEEN;
    const float misfit = run(x);
    image.seen = 0xFFFF;
    TEST_ASSERT_TRUE(run(y) == misfit);
    TEST_ASSERT_EQUAL_MEMORY(x, y, sizeof x);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_pose_that_agrees_stays);
    RUN_TEST(nor_does_perspective_move_it);
    RUN_TEST(what_disagrees_shrinks_by_the_weight);
    RUN_TEST(depths_stay);
    RUN_TEST(without_a_share_nothing_moves);
    RUN_TEST(a_share_of_one_moves_a_joint_to_the_image_and_others_stay);
    RUN_TEST(joints_that_were_not_seen_stay_where_they_are);
    RUN_TEST(the_mean_of_the_seen_joints_stays);
    RUN_TEST(a_mirrored_image_mirrors_the_pose);
    RUN_TEST(images_of_no_size_or_upside_down_leave_the_pose);
    RUN_TEST(equal_points_stay_at_the_origin);
    RUN_TEST(no_joints_leave_the_pose_and_bits_beyond_them_do_not_count);
    return UNITY_END();
}
