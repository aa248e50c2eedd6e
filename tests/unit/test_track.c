/* optional/video.h from within: what a track reports of itself, by the definitions of its header, in double.
 *
 * SPDX-License-Identifier: MIT
 */
#include "helpers.h"
#include "network/model.h" /* to make a model that takes the wrong mirror image */

enum { KNOWN_MS = 300 };
#define MOST_LOG_ODDS 6.0
#define STATE_TOLERANCE 2e-5F /* a few dozen roundings of numbers of about 1 */

static edml_work work;
static edml_track track, was;
static edml_pose pose, lifted;
static edml_keypoint in[EDML_JOINTS];

static void run(uint32_t time)
{
    was = track;
    TEST_ASSERT_EQUAL_INT(
        EDML_OK, edml_track_lift(&pose, &track, in, time, NULL, &edml_direct_f32, &work, sizeof work));
}

/* Somebody who turns, at so many degrees, 200 pixels a metre. */
static void see(double degrees)
{
    const double angle = degrees * 3.14159265358979 / 180;
    const rotation3 by = {{{cos(angle), 0, sin(angle)}, {0, 1, 0}, {-sin(angle), 0, cos(angle)}}};
    edml_point x[EDML_JOINTS];
    human_pose(x);
    rotate_points(x, by, x);
    photograph(in, x);
}

static void shift(float x, float y)
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        in[j].x += x;
        in[j].y += y;
    }
}

static double at_most(double limit, double value)
{
    return fabs(value) < limit ? value : copysign(limit, value);
}

/* A mean over a fifth of a second. */
static float averaged(float before, double value, double seconds)
{
    return (float)((double)before + seconds / (seconds + 0.2) * (value - (double)before));
}

/* ---- Jitter and steps ------------------------------------------------------------------------------ */

static void check_jitter_and_image_step(double seconds)
{
    const double size = size_in_image(in);
    double jitter = 0, steps = 0;
    int count = 0;
    for (int j = 0; j < EDML_JOINTS; j++) {
        const edml_tracked_joint *joint = &was.joint[j];
        if (!(in[j].c > 0) || joint->age > KNOWN_MS) continue;
        const double x = (double)(in[j].x - joint->image.at.x), y = (double)(in[j].y - joint->image.at.y);
        const double off_x = at_most(3, (x - (double)joint->image.rate.x * seconds) / size);
        const double off_y = at_most(3, (y - (double)joint->image.rate.y * seconds) / size);
        jitter += sqrt(0.5) *
                  hypot(off_x - (double)joint->innovation_x, off_y - (double)joint->innovation_y);
        steps += hypot(at_most(3, x / size), at_most(3, y / size));
        count++;
        TEST_ASSERT_FLOAT_WITHIN(STATE_TOLERANCE, (float)off_x, track.joint[j].innovation_x);
        TEST_ASSERT_FLOAT_WITHIN(STATE_TOLERANCE, (float)off_y, track.joint[j].innovation_y);
    }
    TEST_ASSERT_FLOAT_WITHIN(STATE_TOLERANCE, averaged(was.jitter, jitter / count, seconds), track.jitter);
    TEST_ASSERT_FLOAT_WITHIN(STATE_TOLERANCE, averaged(was.image_step, steps / count, seconds),
                             track.image_step);
}

/* From where the lift alone puts the filtered keypoints. */
static void check_space_step(double seconds)
{
    edml_keypoint filtered[EDML_JOINTS];
    double sum = 0;
    for (int j = 0; j < EDML_JOINTS; j++) {
        const edml_point at = track.joint[j].image.at;
        filtered[j] = (edml_keypoint){at.x, at.y, track.joint[j].age <= KNOWN_MS ? 1 : 0};
    }
    TEST_ASSERT_EQUAL_INT(EDML_OK,
                          edml_lift(&lifted, filtered, NULL, &edml_direct_f32, &work, sizeof work));
    for (int j = 0; j < EDML_JOINTS; j++)
        sum += distance_between(lifted.joint[j], was.joint[j].space.at) / EDML_JOINTS;
    TEST_ASSERT_FLOAT_WITHIN(STATE_TOLERANCE, averaged(was.space_step, sum, seconds), track.space_step);
}

/* Noise, frames of different lengths, joints that come and go, one far off. */
static void jitter_and_steps_are_means_over_a_fifth_of_a_second(void)
{
    static const uint32_t ms[] = {20, 33, 50, 100};
    rng r = rng_seed(301);
    uint32_t time = 0;
    edml_track_start(&track);
    for (int n = 0; n < 46; n++) {
        see(0.5 * n);
        add_noise(&r, in, n < 30 ? 3 : 0);
        if (n % 3 == 0) in[n / 3 % 5].c = in[EDML_L_KNEE].c = 0;
        if (n == 45) in[EDML_L_WRIST].x += 4000; /* away from the right one */
        if (n == 44) in[EDML_R_WRIST].y -= 4000;
        time += ms[n % 4];
        run(time);
        TEST_ASSERT_TRUE(!track.leapt && !track.mirrored && !track.swapped);
        if (n == 0) continue;
        check_jitter_and_image_step(ms[n % 4] / 1000.0);
        if (n < 44) check_space_step(ms[n % 4] / 1000.0); /* from then on mirror images are taken */
    }
}

/* ---- The filters ----------------------------------------------------------------------------------- */

static double gain_of(double hertz, double seconds)
{
    const double turn = 6.283185307179586 * seconds * hertz;
    return turn / (1 + turn);
}

/* One joint's one-euro filter with its noise taken off the speed, and the least gain of motion. */
static void check_filtered(edml_moving before, edml_moving after, edml_point seen, double seconds,
                           double unit, edml_smoothing by, double noise, double motion)
{
    const double low = gain_of(4, seconds), noise_speed = sqrt(low / (2 - low)) * noise / seconds;
    const double step[] = {(double)(seen.x - before.at.x), (double)(seen.y - before.at.y),
                           (double)(seen.z - before.at.z)};
    const double old[] = {(double)before.rate.x, (double)before.rate.y, (double)before.rate.z};
    const double at[] = {(double)before.at.x, (double)before.at.y, (double)before.at.z};
    const float found[] = {after.at.x, after.at.y, after.at.z};
    const float rates[] = {after.rate.x, after.rate.y, after.rate.z};
    double rate[3], speed = 0;
    for (int k = 0; k < 3; k++) rate[k] = old[k] + low * (step[k] / seconds - old[k]);
    for (int k = 0; k < 3; k++) speed += rate[k] * rate[k] / (unit * unit);
    const double own = speed > noise_speed * noise_speed ? sqrt(speed - noise_speed * noise_speed) : 0;
    const double alone = gain_of((double)by.cutoff + (double)by.slope * own, seconds);
    for (int k = 0; k < 3; k++) {
        const float tolerance = (float)(2e-5 * (unit + fabs(rate[k]) + fabs(at[k])));
        TEST_ASSERT_FLOAT_WITHIN(tolerance, (float)rate[k], rates[k]);
        TEST_ASSERT_FLOAT_WITHIN(tolerance, (float)(at[k] + fmax(alone, motion) * step[k]), found[k]);
    }
}

static void check_filters(uint32_t ms)
{
    const double size = size_in_image(in), seconds = ms / 1000.0;
    const double full = (double)track.noise_full;
    const double share = full > 0 ? fmin((double)track.jitter / (double)track.image_step, 4) : 0;
    const double part = full > 0 ? share / full : 1, motion = part < 1 ? 1 - part * part * part * part : 0;
    check_space_step(seconds);
    for (int j = 0; j < EDML_JOINTS; j++) {
        const edml_tracked_joint *a = &was.joint[j], *b = &track.joint[j];
        const edml_point seen = {in[j].x, in[j].y, 0};
        if (in[j].c > 0)
            check_filtered(a->image, b->image, seen, seconds + a->age / 1000.0, size, track.smooth_image,
                           share * (double)track.image_step, motion);
        check_filtered(a->space, b->space, lifted.joint[j], seconds, 1, track.smooth_space,
                       share * (double)track.space_step, motion);
        TEST_ASSERT_SAME_BYTES(b->space.at, pose.joint[j]);
    }
}

static void what_is_not_noise_passes_the_filters(void)
{
    static const float full[] = {1, 0.5F, 2, 5, 64, 0}; /* 0: all is filtered in full */
    rng r = rng_seed(302);
    for (int k = 0; k < 6; k++) {
        edml_track_start(&track);
        track.noise_full = full[k];
        for (uint32_t n = 0; n < 50; n++) {
            see(3.0 * n);
            add_noise(&r, in, n % 20 < 10 ? 2 : 0.2F);
            if (n % 10 == 5) in[EDML_L_ANKLE].c = in[EDML_HEAD].c = 0;
            if (n == 42) track.jitter = 20 * track.image_step; /* noisier than can be */
            run(40 * n);
            if (n > 0) check_filters(40);
        }
    }
}

static void the_defaults_are_those_that_were_measured(void)
{
    memset(&track, 0xFF, sizeof track);
    edml_track_start(&track);
    TEST_ASSERT_EQUAL_FLOAT(2, track.smooth_image.cutoff);
    TEST_ASSERT_EQUAL_FLOAT(4, track.smooth_image.slope);
    TEST_ASSERT_EQUAL_FLOAT(2, track.smooth_space.cutoff);
    TEST_ASSERT_EQUAL_FLOAT(2.5F, track.smooth_space.slope);
    TEST_ASSERT_EQUAL_FLOAT(1, track.noise_full);
    TEST_ASSERT_EQUAL_UINT8(0, track.started);
}

static void settings_up_to_the_ends_of_their_ranges_are_taken(void)
{
    static const float full[] = {0, 0.01F, 63.9F, 64};
    static const edml_smoothing by[] = {{1e-6F, 0}, {0.5F, 0.5F}, {3000, 1e30F}, {HUGE_VALF, 0}};
    for (int n = 0; n < 4; n++) {
        edml_track_start(&track);
        see(0);
        track.noise_full = full[n];
        track.smooth_image = by[n];
        track.smooth_space = by[3 - n];
        run(0);
        run(33);
    }
    edml_track_start(&track);
    track.noise_full = 64.1F;
    TEST_ASSERT_EQUAL_INT(EDML_ERR_ARGUMENT, edml_track_lift(&pose, &track, in, 0, NULL, &edml_direct_f32,
                                                             &work, sizeof work));
}

/* ---- A new start ------------------------------------------------------------------------------------ */

static void check_fresh(void)
{
    TEST_ASSERT_EQUAL_UINT32(0, track.elapsed);
    TEST_ASSERT_TRUE(track.jitter == 0 && track.image_step == 0 && track.space_step == 0);
    TEST_ASSERT_TRUE(track.arms_log_odds == 2 && track.legs_log_odds == 2 && track.mirror_log_odds == 2);
    TEST_ASSERT_TRUE(track.held == 0 && track.swapped == 0 && track.mirrored == 0 && track.aside == 0);
    for (int j = 0; j < EDML_JOINTS; j++) {
        const edml_tracked_joint *joint = &track.joint[j];
        TEST_ASSERT_EQUAL_INT(in[j].c > 0, joint->age <= KNOWN_MS);
        TEST_ASSERT_TRUE(!(in[j].c > 0) || (joint->image.at.x == in[j].x && joint->image.at.y == in[j].y));
        TEST_ASSERT_TRUE(joint->space.rate.x == 0 && joint->space.rate.y == 0 && joint->space.rate.z == 0);
        TEST_ASSERT_TRUE(!(in[j].c > 0) || (joint->innovation_x == 0 && joint->innovation_y == 0));
    }
}

/* At the beginning, after a gap, up to the largest that is one, and with somebody else. */
static void a_start_has_no_past(void)
{
    static const uint32_t gap[] = {1001, 5000, UINT32_MAX / 4 + 9, UINT32_MAX / 2};
    rng r = rng_seed(303);
    for (int n = 0; n < 5; n++) {
        edml_track_start(&track);
        see(0);
        in[EDML_HEAD].c = 0;
        run(7);
        check_fresh();
        for (uint32_t k = 1; k < 20; k++) {
            see(3.0 * k);
            add_noise(&r, in, 3);
            run(7 + 33 * k);
        }
        see(9);
        in[EDML_R_ANKLE].c = 0;
        if (n == 4) shift(1000, 0);
        run(7 + 33 * 19 + (n == 4 ? 101 : gap[n]));
        check_fresh();
        TEST_ASSERT_EQUAL_UINT8(n == 4, track.leapt);
    }
}

/* ---- Another person ----------------------------------------------------------------------------------- */

static void stand(uint32_t frames)
{
    edml_track_start(&track);
    for (uint32_t n = 0; n < frames; n++) {
        see(0);
        run(33 * n);
    }
}

/* Over one body size away, and twice as many as there were seconds. */
static void more_time_allows_more_distance(void)
{
    static const uint32_t ms[] = {10, 50, 250, 500, 1000};
    for (int n = 0; n < 10; n++) {
        const double most = 1 + 2.0 * ms[n / 2] / 1000;
        stand(5);
        const int other = n % 2;
        shift((float)(size_in_image(in) * (other ? most + 0.02 : most - 0.02)), 0);
        run(33 * 4 + ms[n / 2]);
        TEST_ASSERT_EQUAL_UINT8(other, track.leapt);
    }
}

static void the_track_waits_for_its_person_for_100_ms(void)
{
    static const uint32_t ms[] = {99, 100, 101};
    for (int n = 0; n < 3; n++) {
        stand(5);
        shift(1000, 0);
        run(33 * 4 + ms[n]);
        TEST_ASSERT_EQUAL_UINT8(1, track.leapt);
        TEST_ASSERT_EQUAL_UINT16(ms[n] <= 100 ? ms[n] : 0, track.aside);
    }
}

static void a_frame_of_another_reports_nothing_of_the_track(void)
{
    stand(5);
    track.held = 5;
    track.swapped = EDML_SWAPPED_ARMS | EDML_SWAPPED_LEGS;
    track.mirrored = 1;
    shift(1000, 0);
    run(33 * 5);
    TEST_ASSERT_TRUE(track.leapt && track.elapsed == 0);
    TEST_ASSERT_TRUE(track.held == 0 && track.swapped == 0 && track.mirrored == 0);
    TEST_ASSERT_EQUAL_MEMORY(was.joint, track.joint, sizeof was.joint);
}

/* The second within which the track can say counts from its own person's last frame. */
static void the_time_aside_counts(void)
{
    stand(5);
    shift(1000, 0);
    run(33 * 5);
    see(0);
    TEST_ASSERT_TRUE(edml_track_distance(&track, in, 33 * 4 + 1000) == 0);
    TEST_ASSERT_TRUE(edml_track_distance(&track, in, 33 * 4 + 1001) == HUGE_VALF);
}

/* ---- Distances ---------------------------------------------------------------------------------------- */

/* Joints go off by less than half of what parts right and left, so that no swap is seen in it. */
static void the_distance_is_the_median_of_all_joints(void)
{
    rng r = rng_seed(304);
    for (int n = 0; n < 200; n++) {
        double off[EDML_JOINTS];
        stand(3);
        const double size = size_in_image(in);
        for (int j = 0; j < EDML_JOINTS; j++) {
            off[j] = (double)uniform(&r, 0, 1);
            in[j].y += (float)off[j];
            if (n % 2 && (j == n % 12 || j == n % 5)) in[j].c = 0;
        }
        int count = 0;
        for (int j = 0; j < EDML_JOINTS; j++)
            if (in[j].c > 0) off[count++] = off[j];
        for (int j = 0; j < count; j++) {
            int less = 0;
            for (int k = 0; k < count; k++) less += off[k] < off[j];
            if (less != count / 2) continue;
            const double least = fmin(size, size_in_image(in)); /* `was` has all joints */
            TEST_ASSERT_FLOAT_WITHIN(1e-5F, (float)(off[j] / least), edml_track_distance(&track, in, 99));
        }
    }
}

static const int right_joint[] = {EDML_R_SHOULDER, EDML_R_ELBOW, EDML_R_WRIST,
                                  EDML_R_HIP,      EDML_R_KNEE,  EDML_R_ANKLE}; /* the left one is 3 on */

/* Right and left in each other's place; the right ones perhaps not seen. */
static void trade(int hide_right)
{
    for (int n = 0; n < 6; n++) {
        edml_keypoint *right = &in[right_joint[n]];
        const edml_keypoint kept = *right;
        right[0] = right[3];
        right[3] = kept;
        if (hide_right) right->c = 0;
    }
}

/* A swap needs both, seen and known; who sees one side alone in the other's place sees something else. */
static void one_side_alone_is_not_swapped(void)
{
    stand(3);
    trade(0);
    TEST_ASSERT_TRUE(edml_track_distance(&track, in, 99) == 0);
    see(0);
    trade(1);
    TEST_ASSERT_TRUE(edml_track_distance(&track, in, 99) > 0.2F);

    stand(3); /* the right arm is not known any more; the left one is where it was */
    for (uint32_t n = 3; n < 20; n++) {
        see(0);
        for (int k = 0; k < 3; k++) in[right_joint[k]].c = 0;
        run(33 * n);
    }
    see(0);
    trade(0);
    for (int j = 0; j < EDML_JOINTS; j++)
        if (j < EDML_R_SHOULDER || j > EDML_L_WRIST) in[j].c = 0;
    TEST_ASSERT_TRUE(edml_track_distance(&track, in, 33 * 20) > 0.2F);
}

/* ---- Right and left ----------------------------------------------------------------------------------- */

/* Right and left are so near each other that the past says little. */
static void see_narrow(double dx, double dy, double size)
{
    see(0);
    for (int n = 0; n < 6; n++) {
        edml_keypoint *right = &in[right_joint[n]];
        const float share = n % 3 == 0 ? 1 : 0.5F; /* joints differ */
        right[3] = right[0];
        right[3].x += share * (float)(dx * size);
        right[3].y += share * (float)(dy * size);
    }
}

static float sides_log_odds(int right, double seconds)
{
    const double size = size_in_image(in);
    double far = 0;
    for (int r = right; r < right + 3; r++) {
        const double x = (double)(in[r].x - in[r + 3].x) / size, y = (double)(in[r].y - in[r + 3].y) / size;
        if (in[r].c > 0 && in[r + 3].c > 0 && was.joint[r + 3].age <= KNOWN_MS &&
            was.joint[r].age <= KNOWN_MS)
            far += 2 * (x * x + y * y);
    }
    const double before = (double)(right == EDML_R_HIP ? was.legs_log_odds : was.arms_log_odds);
    const double link = at_most(MOST_LOG_ODDS, 0.3 * far / seconds);
    return (float)at_most(MOST_LOG_ODDS, fmin(before, link) + 11.7 * seconds);
}

/* As far as where the two would go if they were swapped, in squares: both coordinates, three joints. */
static void sides_that_are_near_each_other_are_doubted(void)
{
    static const double near[][2] = {{0.1, 0.02}, {0.02, 0.1}, {0.05, -0.05}, {0, 0}};
    for (int k = 0; k < 4; k++) {
        for (int hidden = 0; hidden < 6; hidden++) {
            edml_track_start(&track);
            for (uint32_t n = 0; n < 12; n++) {
                see_narrow(near[k][0], near[k][1], 150);
                if (hidden > 0 && n > 4) in[hidden].c = in[14 - hidden].c = 0;
                run(50 * n);
                if (n == 0) continue;
                TEST_ASSERT_FLOAT_WITHIN(1e-3F, sides_log_odds(EDML_R_SHOULDER, 0.05), track.arms_log_odds);
                TEST_ASSERT_FLOAT_WITHIN(1e-3F, sides_log_odds(EDML_R_HIP, 0.05), track.legs_log_odds);
            }
        }
    }
}

/* ---- The mirror image ----------------------------------------------------------------------------------- */

/* Four times the product of the depths parts the two images' squared distances from the past. */
static void a_mirror_image_is_believed_by_its_depths(void)
{
    edml_model good = edml_fconn_f32, bad = edml_fconn_f32;
    int flipped = 0;
    good.fusion[FUSION_SHARE].f32 = bad.fusion[FUSION_SHARE].f32 = 0;
    for (int n = 0; n < 5; n++) bad.mirror[n].f32 *= -1;
    edml_track_start(&track);
    track.smooth_image.cutoff = HUGE_VALF;
    for (uint32_t n = 0; n < 60; n++) {
        const edml_model *model = n % 11 > 6 ? &bad : &good;
        see(20 + 2.0 * n);
        was = track;
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_lift(&lifted, in, NULL, model, &work, sizeof work));
        TEST_ASSERT_EQUAL_INT(EDML_OK,
                              edml_track_lift(&pose, &track, in, 100 * n, NULL, model, &work, sizeof work));
        if (n == 0) continue;
        double products = 0;
        for (int j = 0; j < EDML_JOINTS; j++)
            products += (double)lifted.joint[j].z * (double)was.joint[j].space.at.z;
        const double link = at_most(MOST_LOG_ODDS, 0.15 * 4 * products / 0.1);
        const double carried = fmin((double)was.mirror_log_odds, fabs(link));
        const double now = at_most(MOST_LOG_ODDS, carried + (link < 0 ? -5 : 5));
        const int flip = now < 0, mirrored = flip ? link > 0 : link < 0;
        flipped += flip;
        TEST_ASSERT_FLOAT_WITHIN(1e-3F, (float)fabs(now), track.mirror_log_odds);
        TEST_ASSERT_EQUAL_UINT8(mirrored, track.mirrored);
        for (int j = 0; j < EDML_JOINTS; j++) {
            const edml_moving *a = &was.joint[j].space, *b = &track.joint[j].space;
            const float sign = flip ? -1 : 1, z = mirrored ? -lifted.joint[j].z : lifted.joint[j].z;
            const float low = (float)gain_of(4, 0.1);
            const float rate = sign * a->rate.z + low * ((z - sign * a->at.z) / 0.1F - sign * a->rate.z);
            TEST_ASSERT_FLOAT_WITHIN(1e-3F, rate, b->rate.z);
        }
    }
    TEST_ASSERT_TRUE(flipped >= 3);
}

/* ---- Missing joints ---------------------------------------------------------------------------------------- */

/* By the mean of how the others moved, as they were filtered, in both coordinates. */
static void held_joints_move_with_the_mean_of_the_others(void)
{
    rng r = rng_seed(305);
    edml_track_start(&track);
    for (uint32_t n = 0; n < 30; n++) {
        see(1.0 * n);
        shift(2.0F * (float)n, -3.0F * (float)n);
        add_noise(&r, in, 1);
        const int missing = n % 6 > 3;
        if (missing) in[EDML_HEAD].c = in[EDML_L_ANKLE].c = in[EDML_R_WRIST].c = 0;
        run(33 * n);
        TEST_ASSERT_EQUAL_UINT16(missing ? 1 << EDML_HEAD | 1 << EDML_L_ANKLE | 1 << EDML_R_WRIST : 0,
                                 track.held);
        if (!missing) continue;
        double x = 0, y = 0;
        for (int j = 0; j < EDML_JOINTS; j++) {
            if (!(in[j].c > 0)) continue;
            x += (double)(track.joint[j].image.at.x - was.joint[j].image.at.x) / (EDML_JOINTS - 3);
            y += (double)(track.joint[j].image.at.y - was.joint[j].image.at.y) / (EDML_JOINTS - 3);
        }
        static const int held[] = {EDML_HEAD, EDML_L_ANKLE, EDML_R_WRIST};
        for (int k = 0; k < 3; k++) {
            const edml_point a = was.joint[held[k]].image.at, b = track.joint[held[k]].image.at;
            TEST_ASSERT_FLOAT_WITHIN(1e-3F, (float)x, b.x - a.x);
            TEST_ASSERT_FLOAT_WITHIN(1e-3F, (float)y, b.y - a.y);
            TEST_ASSERT_EQUAL_UINT16(was.joint[held[k]].age + 33, track.joint[held[k]].age);
        }
    }
}

/* ---- The ends of fixed point's range ------------------------------------------------------------------------- */

/* Whoever runs towards the edge of what a pixel can be is expected at the edge, and no farther. */
static void in_integers_nobody_is_expected_beyond_the_range(void)
{
    static edml_work_q work_q;
    static edml_track_q track_q;
    edml_pose_q pose_q;
    edml_keypoint_q in_q[EDML_JOINTS];
    for (int side = -1; side <= 1; side += 2) {
        edml_track_start_q(&track_q);
        for (uint32_t n = 0; n < 30; n++) {
            see(0);
            shift((float)side * (5500 + 60 * (float)n), 0);
            to_q16(in_q, in);
            TEST_ASSERT_EQUAL_INT(EDML_OK, edml_track_lift_q(&pose_q, &track_q, in_q, 33 * n, NULL,
                                                             &edml_distances_w16, &work_q, sizeof work_q));
        }
        for (int j = 0; j < EDML_JOINTS; j++) in_q[j].x = side * ((1 << 29) - 65536);
        TEST_ASSERT_TRUE(edml_track_distance_q(&track_q, in_q, 33 * 29 + 1000) < 65536 / 10);
    }
}

/* 64 body sizes are the most, as where the frame is a point. */
static void in_integers_distances_end_at_64(void)
{
    static edml_work_q work_q;
    static edml_track_q track_q;
    edml_pose_q pose_q;
    edml_keypoint_q in_q[EDML_JOINTS];
    edml_track_start_q(&track_q);
    see(0);
    to_q16(in_q, in);
    for (uint32_t n = 0; n < 3; n++)
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_track_lift_q(&pose_q, &track_q, in_q, 33 * n, NULL,
                                                         &edml_distances_w16, &work_q, sizeof work_q));
    for (int j = 0; j < EDML_JOINTS; j++) in_q[j].x = in_q[j].y = 1 << 24;
    TEST_ASSERT_EQUAL_INT32(64 << 16, edml_track_distance_q(&track_q, in_q, 99));
    for (int j = 0; j < EDML_JOINTS; j++) in_q[j].x += (j % 2) << 14; /* a quarter of a pixel wide */
    TEST_ASSERT_EQUAL_INT32(64 << 16, edml_track_distance_q(&track_q, in_q, 99));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(jitter_and_steps_are_means_over_a_fifth_of_a_second);
    RUN_TEST(what_is_not_noise_passes_the_filters);
    RUN_TEST(the_defaults_are_those_that_were_measured);
    RUN_TEST(settings_up_to_the_ends_of_their_ranges_are_taken);
    RUN_TEST(a_start_has_no_past);
    RUN_TEST(more_time_allows_more_distance);
    RUN_TEST(the_track_waits_for_its_person_for_100_ms);
    RUN_TEST(a_frame_of_another_reports_nothing_of_the_track);
    RUN_TEST(the_time_aside_counts);
    RUN_TEST(the_distance_is_the_median_of_all_joints);
    RUN_TEST(one_side_alone_is_not_swapped);
    RUN_TEST(sides_that_are_near_each_other_are_doubted);
    RUN_TEST(a_mirror_image_is_believed_by_its_depths);
    RUN_TEST(held_joints_move_with_the_mean_of_the_others);
    RUN_TEST(in_integers_distances_end_at_64);
    RUN_TEST(in_integers_nobody_is_expected_beyond_the_range);
    return UNITY_END();
}
