/* optional/video.h: video.
 *
 * SPDX-License-Identifier: MIT
 */
#include <float.h>

#include "helpers.h"
#include "q24.h"
#include "network/model.h" /* to make models that take the wrong mirror image */

enum { FRAME = 33 }; /* ms */

static edml_work work;
static edml_track track, other;
static edml_pose pose, again, before;
static edml_keypoint in[EDML_JOINTS], whole[EDML_JOINTS];

static edml_status run(uint32_t time)
{
    return edml_track_lift(&pose, &track, in, time, NULL, &edml_direct_f32, &work, sizeof work);
}

static edml_status run_other(uint32_t time)
{
    return edml_track_lift(&again, &other, in, time, NULL, &edml_direct_f32, &work, sizeof work);
}

/* Somebody who turns on the spot, steps of 2 degrees. */
static void see_turned(int steps)
{
    static const double c = 0.99939082701909576, s = 0.03489949670250097;
    rotation3 by = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    for (int n = 0; n < steps; n++) {
        const double x = by.at[0][0], z = by.at[0][2];
        by.at[0][0] = c * x - s * z;
        by.at[0][2] = s * x + c * z;
    }
    by.at[2][0] = -by.at[0][2];
    by.at[2][2] = by.at[0][0];
    edml_point x[EDML_JOINTS], turned[EDML_JOINTS];
    human_pose(x);
    rotate_points(turned, by, x);
    photograph(in, turned);
}

static void swap_detected(int right)
{
    for (int r = right; r < right + 3; r++) {
        const edml_keypoint keypoint = in[r];
        in[r] = in[r + 3];
        in[r + 3] = keypoint;
    }
}

static void start(void)
{
    edml_track_start(&track);
    edml_track_start(&other);
    memset(&pose, 0, sizeof pose);
    memset(&again, 0, sizeof again);
}

/* ---- Steady input ------------------------------------------------------------------------------- */

static void somebody_who_stands_still_stays_as_lifted(void)
{
    start();
    see_turned(0);
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_lift(&again, in, NULL, &edml_direct_f32, &work, sizeof work));
    for (uint32_t n = 0; n < 40; n++) {
        TEST_ASSERT_EQUAL_INT(EDML_OK, run(n * FRAME));
        TEST_ASSERT_EQUAL_MEMORY(again.joint, pose.joint, sizeof pose.joint);
        TEST_ASSERT_EQUAL_UINT16(ALL_SEEN, pose.seen);
        TEST_ASSERT_TRUE(pose.misfit == again.misfit);
        TEST_ASSERT_TRUE(!track.held && !track.swapped && !track.mirrored);
        TEST_ASSERT_EQUAL_UINT32(n == 0 ? 0 : FRAME, track.elapsed);
    }
}

static void the_hips_stay_opposite(void)
{
    rng r = rng_seed(70);
    start();
    for (int n = 0; n < 60; n++) {
        see_turned(n);
        add_noise(&r, in, 5);
        TEST_ASSERT_EQUAL_INT(EDML_OK, run((uint32_t)n * FRAME));
        const edml_point a = pose.joint[EDML_R_HIP], b = pose.joint[EDML_L_HIP];
        TEST_ASSERT_ERROR_UP_TO(ROUNDING, fabsf(a.x + b.x) + fabsf(a.y + b.y) + fabsf(a.z + b.z));
    }
}

static void the_image_may_be_of_any_size(void)
{
    rng r = rng_seed(71);
    start();
    for (int n = 0; n < 60; n++) {
        see_turned(n);
        add_noise(&r, in, 5);
        TEST_ASSERT_EQUAL_INT(EDML_OK, run((uint32_t)n * FRAME));
        for (int j = 0; j < EDML_JOINTS; j++) {
            in[j].x *= 8;
            in[j].y *= 8;
        }
        TEST_ASSERT_EQUAL_INT(EDML_OK, run_other((uint32_t)n * FRAME));
        TEST_ASSERT_EQUAL_MEMORY(again.joint, pose.joint, sizeof pose.joint);
    }
}

/* ---- The filters ------------------------------------------------------------------------------- */

/* Mean second difference of three frames' joints. */
static double second_difference(edml_pose frame[3])
{
    double sum = 0;
    for (int j = 0; j < EDML_JOINTS; j++) {
        const edml_point a = frame[0].joint[j], b = frame[1].joint[j], c = frame[2].joint[j];
        const edml_point middle = {(a.x + c.x) / 2, (a.y + c.y) / 2, (a.z + c.z) / 2};
        sum += 2 * distance_between(middle, b) / EDML_JOINTS;
    }
    return sum;
}

static void noise_is_more_than_halved(void)
{
    edml_pose alone[3] = {{{{0, 0, 0}}, 0, 0}}, steady[3] = {{{{0, 0, 0}}, 0, 0}};
    double jitter_alone = 0, jitter = 0;
    rng r = rng_seed(72);
    start();
    for (int n = 0; n < 120; n++) {
        see_turned(n);
        add_noise(&r, in, 5);
        memmove(alone, alone + 1, 2 * sizeof *alone);
        memmove(steady, steady + 1, 2 * sizeof *steady);
        TEST_ASSERT_EQUAL_INT(EDML_OK,
                              edml_lift(&alone[2], in, NULL, &edml_direct_f32, &work, sizeof work));
        TEST_ASSERT_EQUAL_INT(EDML_OK, run((uint32_t)n * FRAME));
        steady[2] = pose;
        if (n < 10) continue;
        jitter_alone += second_difference(alone);
        jitter += second_difference(steady);
    }
    TEST_ASSERT_TRUE(jitter > 0 && jitter < jitter_alone / 2);
}

/* The filter of the paper, in double, on one coordinate of the image. */
typedef struct {
    double at, rate;
} moving;

static void filter(moving *joint, double seen, double seconds, double size)
{
    const double turn = 2 * 3.14159265358979 * seconds, slow = turn * 4.0; /* the speed's cutoff */
    joint->rate += slow / (1 + slow) * ((seen - joint->at) / seconds - joint->rate);
    const double cutoff = (double)track.smooth_image.cutoff +
                          (double)track.smooth_image.slope * fabs(joint->rate) / size;
    joint->at += turn * cutoff / (1 + turn * cutoff) * (seen - joint->at);
}

/* Everything moves along the image; in a frame a wrist is missing, and moves as the rest does. */
static void the_filter_is_the_papers(void)
{
    moving rest = {0, 0}, wrist = {0, 0};
    double missed = 0;
    uint32_t time = 0;
    start();
    track.noise_full = 0;
    see_turned(0);
    TEST_ASSERT_EQUAL_INT(EDML_OK, run(time));
    other = track;
    for (int n = 1; n < 30; n++) {
        const double seconds = 0.040 + 0.001 * (n % 3), was = rest.at;
        see_turned(0);
        for (int j = 0; j < EDML_JOINTS; j++) in[j].x += (float)(n * n);
        if (n == 15) in[EDML_L_WRIST].c = 0;
        filter(&rest, n * n, seconds, size_in_image(in));
        if (n == 15)
            wrist.at += rest.at - was;
        else
            filter(&wrist, n * n, seconds + missed, size_in_image(in));
        missed = n == 15 ? seconds : 0;
        time += 40 + (uint32_t)n % 3;
        TEST_ASSERT_EQUAL_INT(EDML_OK, run(time));
        const float rest_at = track.joint[EDML_NECK_BASE].image.at.x -
                              other.joint[EDML_NECK_BASE].image.at.x;
        const float wrist_at = track.joint[EDML_L_WRIST].image.at.x - other.joint[EDML_L_WRIST].image.at.x;
        TEST_ASSERT_FLOAT_WITHIN(0.01F, (float)rest.at, rest_at);
        TEST_ASSERT_FLOAT_WITHIN(0.01F, (float)wrist.at, wrist_at);
    }
}

/* Mean distance of a moving person's poses, in metres, from those of each frame alone. */
static double lag_of(float noise, float pixels)
{
    double sum = 0;
    rng r = rng_seed(74);
    start();
    track.noise_full = noise;
    for (int n = 0; n < 60; n++) {
        see_turned(n);
        add_noise(&r, in, pixels);
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_lift(&again, in, NULL, &edml_direct_f32, &work, sizeof work));
        TEST_ASSERT_EQUAL_INT(EDML_OK, run((uint32_t)n * FRAME));
        for (int j = 0; j < EDML_JOINTS; j++)
            sum += distance_between(again.joint[j], pose.joint[j]) / (60 * EDML_JOINTS);
    }
    return sum;
}

/* By what share of their steps is noise, however small the steps are. */
static void motion_is_filtered_less_than_noise(void)
{
    edml_track_start(&track);
    const float full = track.noise_full;
    const double exact = lag_of(full, 0);
    TEST_ASSERT_TRUE(track.jitter > 0 && track.jitter < full * track.image_step / 2);
    TEST_ASSERT_TRUE(exact < lag_of(0, 0) / 4);
    const double noisy = lag_of(full, 20);
    TEST_ASSERT_TRUE(track.jitter > full * track.image_step);
    TEST_ASSERT_TRUE(noisy > 0.9 * lag_of(0, 20));
}

/* Half a turn a second, as 15 frames show it. */
static void motion_is_not_taken_for_noise(void)
{
    start();
    for (int n = 0; n < 60; n++) {
        see_turned(6 * n);
        TEST_ASSERT_EQUAL_INT(EDML_OK, run((uint32_t)n * 2 * FRAME));
        TEST_ASSERT_TRUE(n < 15 || track.jitter < track.noise_full * track.image_step / 3);
    }
}

/* Mean move of a joint in a frame, metres, and the largest, of somebody who stands still. */
static double trembling(float pixels, uint32_t seed, double *worst)
{
    enum { FRAMES = 150, SETTLED = 30 };
    double sum = 0;
    rng r = rng_seed(seed);
    start();
    *worst = 0;
    for (int n = 0; n < FRAMES; n++) {
        see_turned(0);
        add_noise(&r, in, pixels);
        before = pose;
        TEST_ASSERT_EQUAL_INT(EDML_OK, run((uint32_t)n * FRAME));
        for (int j = 0; j < EDML_JOINTS && n >= SETTLED; j++) {
            const double move = distance_between(before.joint[j], pose.joint[j]);
            sum += move / ((FRAMES - SETTLED) * EDML_JOINTS);
            if (move > *worst) *worst = move;
        }
    }
    return sum;
}

/* A half of a percent of the height in the image is much more in depth.  The worst move is that of the case of someone
 * who stands still (tests/python/cases). */
static void somebody_who_stands_still_does_not_tremble(void)
{
    double worst;
    see_turned(0);
    const float half_percent = 0.005F * (in[EDML_R_ANKLE].y - in[EDML_HEAD].y);
    TEST_ASSERT_TRUE(half_percent > 0);
    for (uint32_t seed = 76; seed < 86; seed++) {
        TEST_ASSERT_TRUE(trembling(half_percent, seed, &worst) < 0.004);
        TEST_ASSERT_TRUE(worst < 0.05);
        TEST_ASSERT_TRUE(trembling(4 * half_percent, seed, &worst) < 0.016);
    }
}

static void without_filters_frames_are_as_lifted(void)
{
    rng r = rng_seed(73);
    start();
    track.smooth_image.cutoff = track.smooth_space.cutoff = HUGE_VALF;
    for (int n = 0; n < 30; n++) {
        see_turned(n);
        add_noise(&r, in, 2);
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_lift(&again, in, NULL, &edml_direct_f32, &work, sizeof work));
        TEST_ASSERT_EQUAL_INT(EDML_OK, run((uint32_t)n * FRAME));
        TEST_ASSERT_ERROR_UP_TO(0.0001F, worst_joint_error(again.joint, pose.joint));
    }
}

/* ---- Right and left ----------------------------------------------------------------------------- */

/* With some limbs swapped in three frames, the poses are those of a video without. */
static void check_swap(int kind, int missing)
{
    start();
    for (int n = 0; n < 40; n++) {
        const int wrong = n >= 20 && n < 23;
        see_turned(n / 2);
        if (missing && n >= 15) in[EDML_L_WRIST].c = in[EDML_R_KNEE].c = 0;
        memcpy(whole, in, sizeof whole);
        TEST_ASSERT_EQUAL_INT(EDML_OK, run_other((uint32_t)n * FRAME));
        if (wrong && (kind & EDML_SWAPPED_ARMS)) swap_detected(EDML_R_SHOULDER);
        if (wrong && (kind & EDML_SWAPPED_LEGS)) swap_detected(EDML_R_HIP);
        TEST_ASSERT_EQUAL_INT(EDML_OK, run((uint32_t)n * FRAME));
        TEST_ASSERT_EQUAL_UINT8(wrong ? kind : 0, track.swapped);
        TEST_ASSERT_EQUAL_MEMORY(&again, &pose, sizeof pose); /* and what was seen */
        edml_track_swap_sides(in, &track);
        TEST_ASSERT_EQUAL_MEMORY(whole, in, sizeof in);
    }
}

static void swaps_are_undone(void)
{
    for (int kind = 1; kind <= 3; kind++) {
        check_swap(kind, 0);
        check_swap(kind, 1);
    }
}

static void a_turn_is_not_undone(void)
{
    for (int steps = 1; steps <= 6; steps++) { /* a frame: up to a turn a second */
        start();
        for (int n = 0; n < 120; n++) {
            see_turned(steps * n);
            TEST_ASSERT_EQUAL_INT(EDML_OK, run((uint32_t)n * FRAME));
            TEST_ASSERT_EQUAL_UINT8(0, track.swapped);
        }
    }
}

static void what_lasts_is_no_swap(void)
{
    int undone = 0;
    start();
    for (int n = 0; n < 60; n++) {
        see_turned(0);
        if (n >= 20) swap_detected(EDML_R_HIP);
        TEST_ASSERT_EQUAL_INT(EDML_OK, run((uint32_t)n * FRAME));
        if (track.swapped) undone++;
        TEST_ASSERT_TRUE(track.swapped == 0 || (n >= 20 && n < 20 + 500 / FRAME));
        if (track.swapped) swap_detected(EDML_R_HIP);
        for (int j = 0; j < EDML_JOINTS; j++) /* none on its way between right and left */
            TEST_ASSERT_FLOAT_WITHIN(0.01F, in[j].x, track.joint[j].image.at.x);
    }
    TEST_ASSERT_TRUE(undone * FRAME >= 250);
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_lift(&again, in, NULL, &edml_direct_f32, &work, sizeof work));
    TEST_ASSERT_ERROR_UP_TO(0.005F, worst_joint_error(again.joint, pose.joint));
}

/* ---- The mirror image ---------------------------------------------------------------------------- */

/* A model that takes the mirror image, if `right` is 0; it does not fuse, so mirror images differ in nothing
 * but the sign of depth. */
static edml_model doubtful_model(int right)
{
    edml_model model = edml_fconn_f32;
    for (int n = 0; n < 5; n++) model.mirror[n].f32 *= right ? 1 : -1;
    model.fusion[FUSION_SHARE].f32 = 0;
    return model;
}

static void a_mirror_image_is_taken_only_if_it_persists(void)
{
    const edml_model good = doubtful_model(1), bad = doubtful_model(0);
    int overruled = 0;
    start();
    for (int n = 0; n < 120; n++) {
        const int wrong = n == 30 || n >= 60;
        see_turned(45);
        const edml_model *model = wrong ? &bad : &good;
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_lift(&again, in, NULL, model, &work, sizeof work));
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_track_lift(&pose, &track, in, (uint32_t)n * FRAME, NULL, model,
                                                       &work, sizeof work));
        if (n < 60) TEST_ASSERT_EQUAL_UINT8(wrong, track.mirrored);
        if (n == 29) before = pose;
        if (n > 29 && n < 60) TEST_ASSERT_ERROR_UP_TO(0.0001F, worst_joint_error(before.joint, pose.joint));
        if (n >= 60) overruled += track.mirrored;
        if (!track.mirrored) TEST_ASSERT_ERROR_UP_TO(0.0001F, worst_joint_error(again.joint, pose.joint));
    }
    TEST_ASSERT_TRUE(overruled >= 1 && overruled < 10);
}

/* ---- Missing joints ------------------------------------------------------------------------------ */

static void a_missing_joint_is_held_for_300_ms(void)
{
    const uint16_t wrist = 1 << EDML_R_WRIST;
    start();
    for (int n = 0; n < 20; n++) {
        const int missing = n >= 10 && n < 16;
        const int held = missing && n <= 12;
        see_turned(0);
        if (missing) in[EDML_R_WRIST].c = 0;
        if (missing) in[EDML_R_WRIST].x = NAN; /* is not looked at */
        TEST_ASSERT_EQUAL_INT(EDML_OK, run((uint32_t)n * 100));
        TEST_ASSERT_EQUAL_UINT16(held ? wrist : 0, track.held);
        TEST_ASSERT_EQUAL_UINT16(missing ? ALL_SEEN & ~wrist : ALL_SEEN, pose.seen);
        if (n == 9) before = pose;
        if (n >= 9 && (held || !missing) && n < 16)
            TEST_ASSERT_EQUAL_MEMORY(before.joint, pose.joint, sizeof pose.joint);
    }
}

static void a_held_joint_moves_along(void)
{
    start();
    for (int n = 0; n < 15; n++) {
        see_turned(0);
        for (int j = 0; j < EDML_JOINTS; j++) in[j].x += 3 * (float)n;
        if (n >= 10) in[EDML_L_ANKLE].c = 0;
        TEST_ASSERT_EQUAL_INT(EDML_OK, run((uint32_t)n * FRAME));
        const float leg = track.joint[EDML_L_ANKLE].image.at.x - track.joint[EDML_L_KNEE].image.at.x;
        TEST_ASSERT_FLOAT_WITHIN(1, in[EDML_L_ANKLE].x - in[EDML_L_KNEE].x, leg);
    }
}

static void holding_does_not_make_up_a_person(void)
{
    start();
    see_turned(0);
    TEST_ASSERT_EQUAL_INT(EDML_OK, run(0));
    for (int j = 0; j < 7; j++) in[j].c = 0;
    TEST_ASSERT_EQUAL_INT(EDML_OK, run(100)); /* 7 seen, 7 held */
    TEST_ASSERT_EQUAL_UINT16(0x7F, track.held);
    in[7].c = 0;
    TEST_ASSERT_EQUAL_INT(EDML_ERR_TOO_FEW_JOINTS, run(200));
    in[7].c = 1;
    TEST_ASSERT_EQUAL_INT(EDML_ERR_TOO_FEW_JOINTS, run(401)); /* too few for the lift */
}

/* ---- The distance of a frame ---------------------------------------------------------------------- */

static void shift(float pixels)
{
    for (int j = 0; j < EDML_JOINTS; j++) in[j].x += pixels;
}

/* Frames of somebody who stands still. */
static void stand(int frames)
{
    start();
    see_turned(0);
    for (uint32_t n = 0; n < (uint32_t)frames; n++) TEST_ASSERT_EQUAL_INT(EDML_OK, run(n * FRAME));
}

static void the_distance_is_in_body_sizes(void)
{
    stand(5);
    const edml_track kept = track;
    const float size = (float)size_in_image(in);
    TEST_ASSERT_TRUE(edml_track_distance(&track, in, 5 * FRAME) == 0);
    shift(size);
    TEST_ASSERT_FLOAT_WITHIN(0.001F, 1, edml_track_distance(&track, in, 5 * FRAME));
    TEST_ASSERT_FLOAT_WITHIN(0.001F, 1, edml_track_distance(&track, in, 5 * FRAME + 500));
    in[EDML_L_WRIST].c = in[EDML_R_ANKLE].c = 0;
    in[EDML_R_ANKLE].x = NAN; /* is not looked at */
    TEST_ASSERT_FLOAT_WITHIN(0.15F, 1, edml_track_distance(&track, in, 5 * FRAME));
    see_turned(0);
    for (int j = 0; j < EDML_JOINTS; j++) { /* a smaller person counts in their own size */
        in[j].x = in[j].x / 4 + 4 * size;
        in[j].y = in[j].y / 4;
    }
    TEST_ASSERT_TRUE(edml_track_distance(&track, in, 5 * FRAME) > 10);
    TEST_ASSERT_EQUAL_MEMORY(&kept, &track, sizeof track);
}

static void the_distance_forgives_what_detectors_do(void)
{
    stand(5);
    const float size = (float)size_in_image(in);
    swap_detected(EDML_R_HIP);
    swap_detected(EDML_R_SHOULDER);
    TEST_ASSERT_TRUE(edml_track_distance(&track, in, 5 * FRAME) == 0);
    in[EDML_L_WRIST].x += 100 * size;
    in[EDML_R_KNEE].y -= 100 * size;
    in[EDML_HEAD].c = 0;
    TEST_ASSERT_TRUE(edml_track_distance(&track, in, 5 * FRAME) == 0);
}

/* Somebody who walks by is expected farther on. */
static void the_distance_is_from_where_joints_are_expected(void)
{
    start();
    see_turned(0);
    const float size = (float)size_in_image(in);
    for (uint32_t n = 0; n < 30; n++) {
        const float near = edml_track_distance(&track, in, n * FRAME);
        TEST_ASSERT_TRUE(n <= 20 || near < 0.03F);
        TEST_ASSERT_TRUE(n <= 20 || edml_track_distance(&track, in, n * FRAME + 500) > 1);
        TEST_ASSERT_EQUAL_INT(EDML_OK, run(n * FRAME));
        shift(size / 10);
    }
}

static void the_distance_is_huge_where_nothing_is_known(void)
{
    stand(3);
    TEST_ASSERT_TRUE(edml_track_distance(&track, in, 2 * FRAME + 1000) == 0);
    const uint32_t wrong[] = {2 * FRAME, FRAME, 2 * FRAME + 1001, 2 * FRAME + UINT32_MAX / 2 + 9};
    for (unsigned n = 0; n < sizeof wrong / sizeof *wrong; n++)
        TEST_ASSERT_TRUE(edml_track_distance(&track, in, wrong[n]) == HUGE_VALF);
    edml_track_start(&other);
    TEST_ASSERT_TRUE(edml_track_distance(&other, in, 9 * FRAME) == HUGE_VALF);
    TEST_ASSERT_TRUE(edml_track_distance(NULL, in, 9 * FRAME) == HUGE_VALF);
    TEST_ASSERT_TRUE(edml_track_distance(&track, NULL, 9 * FRAME) == HUGE_VALF);
    memcpy(whole, in, sizeof whole);
    in[3].y = NAN;
    TEST_ASSERT_TRUE(edml_track_distance(&track, in, 9 * FRAME) == HUGE_VALF);
    for (int j = 0; j < EDML_JOINTS; j++) in[j].x = in[j].y = 0; /* a point has no size */
    TEST_ASSERT_TRUE(edml_track_distance(&track, in, 9 * FRAME) == 64);
    for (int j = 0; j < EDML_JOINTS; j++) in[j].x = j % 2 ? 1e37F : -3e37F;
    TEST_ASSERT_TRUE(edml_track_distance(&track, in, 9 * FRAME) > 1);
    memcpy(in, whole, sizeof whole);
    for (int j = 0; j < EDML_JOINTS; j++) in[j].c = 0;
    TEST_ASSERT_TRUE(edml_track_distance(&track, in, 9 * FRAME) == HUGE_VALF);
}

/* ---- Another person ------------------------------------------------------------------------------- */

/* Frames from `first` to before `end` show somebody 1.5 body sizes to the right, turned away. */
static void see_one_of_two(int n, int first, int end)
{
    see_turned(n);
    if (n < first || n >= end) return;
    const float size = (float)size_in_image(in);
    see_turned(n + 80);
    shift(1.5F * size);
}

/* Frames of somebody else are lifted by themselves, and leave nothing behind. */
static void another_person_for_a_moment_leaves_no_trace(void)
{
    for (int frames = 1; frames <= 3; frames++) {
        start();
        for (int n = 0; n < 40; n++) {
            const int wrong = n >= 20 && n < 20 + frames;
            see_one_of_two(n, 20, 20 + frames);
            TEST_ASSERT_EQUAL_INT(wrong || n == 0,
                                  edml_track_distance(&track, in, (uint32_t)n * FRAME) > 1);
            TEST_ASSERT_EQUAL_INT(EDML_OK, run((uint32_t)n * FRAME));
            TEST_ASSERT_EQUAL_UINT8(wrong, track.leapt);
            TEST_ASSERT_EQUAL_INT(wrong || n == 0, track.elapsed == 0);
            if (wrong)
                TEST_ASSERT_EQUAL_INT(EDML_OK,
                                      edml_lift(&again, in, NULL, &edml_direct_f32, &work, sizeof work));
            else /* a track that does not see these frames */
                TEST_ASSERT_EQUAL_INT(EDML_OK, run_other((uint32_t)n * FRAME));
            TEST_ASSERT_EQUAL_MEMORY(&again, &pose, sizeof pose);
        }
        TEST_ASSERT_EQUAL_MEMORY(&other, &track, sizeof track);
    }
}

static void another_person_who_stays_is_followed(void)
{
    start();
    for (int n = 0; n < 40; n++) {
        see_one_of_two(n, 20, 40);
        TEST_ASSERT_EQUAL_INT(EDML_OK, run((uint32_t)n * FRAME));
        TEST_ASSERT_EQUAL_UINT8(n >= 20 && n <= 23, track.leapt);
        if (n >= 23) { /* as a track that begins there */
            TEST_ASSERT_EQUAL_INT(EDML_OK, run_other((uint32_t)n * FRAME));
            TEST_ASSERT_EQUAL_MEMORY(&again, &pose, sizeof pose);
            TEST_ASSERT_EQUAL_UINT32(n == 23 ? 0 : FRAME, track.elapsed);
        }
        TEST_ASSERT_EQUAL_INT(EDML_ERR_TIME, run((uint32_t)n * FRAME));
    }
}

/* First one half of the joints is seen, then the other one, by a model that takes so few. */
static void a_frame_that_shares_no_joint_is_of_another(void)
{
    edml_model bold = edml_direct_f32;
    bold.fewest_joints = EDML_JOINTS / 2;
    start();
    for (uint32_t n = 0; n < 2; n++) {
        see_turned(0);
        for (int j = 0; j < EDML_JOINTS; j++) in[j].c = j / 7 == (int)n;
        TEST_ASSERT_EQUAL_INT(
            EDML_OK, edml_track_lift(&pose, &track, in, n * FRAME, NULL, &bold, &work, sizeof work));
        TEST_ASSERT_EQUAL_UINT8(n, track.leapt);
    }
}

/* At few frames a second, somebody who walks by is not taken for another. */
static void a_walk_at_two_frames_a_second_is_no_leap(void)
{
    start();
    see_turned(0);
    const float size = (float)size_in_image(in);
    for (uint32_t n = 0; n < 10; n++) {
        TEST_ASSERT_EQUAL_INT(EDML_OK, run(n * 500));
        TEST_ASSERT_EQUAL_UINT8(0, track.leapt);
        shift(1.4F * size);
    }
}

/* ---- Up ------------------------------------------------------------------------------------------ */

/* The first frame is not filtered; somebody who stands still stays as lifted. */
static void up_goes_to_the_lift(void)
{
    static const edml_point up = {1, -8, 5};
    start();
    see_turned(10);
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_lift(&again, in, &up, &edml_distances_f32, &work, sizeof work));
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_lift(&before, in, NULL, &edml_distances_f32, &work, sizeof work));
    TEST_ASSERT_TRUE(worst_joint_error(again.joint, before.joint) > 0.0001F);
    for (uint32_t n = 0; n < 5; n++) {
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_track_lift(&pose, &track, in, n * FRAME, &up,
                                                       &edml_distances_f32, &work, sizeof work));
        TEST_ASSERT_EQUAL_MEMORY(again.joint, pose.joint, sizeof pose.joint);
    }
}

static void bad_up_leaves_no_trace(void)
{
    static const edml_point bad[] = {{0, 0, 0}, {NAN, -1, 0}, {0, INFINITY, 0}};
    start();
    see_turned(0);
    TEST_ASSERT_EQUAL_INT(EDML_OK, run(0));
    other = track;
    again = pose;
    for (int n = 0; n < 3; n++) {
        TEST_ASSERT_EQUAL_INT(
            n == 0 ? EDML_ERR_DEGENERATE : EDML_ERR_NOT_FINITE,
            edml_track_lift(&pose, &track, in, FRAME, &bad[n], &edml_direct_f32, &work, sizeof work));
        TEST_ASSERT_EQUAL_MEMORY(&other, &track, sizeof track);
        TEST_ASSERT_EQUAL_MEMORY(&again, &pose, sizeof pose);
    }
}

/* ---- Time ---------------------------------------------------------------------------------------- */

static void time_does_not_run_backwards(void)
{
    start();
    see_turned(0);
    TEST_ASSERT_EQUAL_INT(EDML_OK, run(1000));
    see_turned(1);
    TEST_ASSERT_EQUAL_INT(EDML_OK, run(1033));
    other = track;
    again = pose;
    const uint32_t wrong[] = {1033, 1032, 1000, 0, UINT32_MAX, 1033 - UINT32_MAX / 2};
    for (unsigned n = 0; n < sizeof wrong / sizeof *wrong; n++) {
        TEST_ASSERT_EQUAL_INT(EDML_ERR_TIME, run(wrong[n]));
        TEST_ASSERT_EQUAL_MEMORY(&other, &track, sizeof track);
        TEST_ASSERT_EQUAL_MEMORY(&again, &pose, sizeof pose);
    }
    TEST_ASSERT_EQUAL_INT(EDML_OK, run(1034));
}

static void a_gap_starts_anew(void)
{
    for (uint32_t gap = 1000; gap <= 1001; gap++) {
        start();
        see_turned(0);
        for (uint32_t n = 0; n < 10; n++) TEST_ASSERT_EQUAL_INT(EDML_OK, run(n * FRAME));
        see_turned(20);
        TEST_ASSERT_EQUAL_INT(EDML_OK, run(9 * FRAME + gap));
        TEST_ASSERT_EQUAL_INT(EDML_OK, run_other(7));
        TEST_ASSERT_EQUAL_UINT32(gap == 1000 ? 1000 : 0, track.elapsed);
        TEST_ASSERT_EQUAL_INT(gap == 1001, memcmp(&again, &pose, sizeof pose) == 0);
    }
}

static void the_clock_may_run_over_its_end(void)
{
    rng r = rng_seed(74);
    start();
    for (uint32_t n = 0; n < 30; n++) {
        see_turned((int)n);
        add_noise(&r, in, 3);
        TEST_ASSERT_EQUAL_INT(EDML_OK, run(n * FRAME));
        TEST_ASSERT_EQUAL_INT(EDML_OK, run_other(n * FRAME - 400));
        TEST_ASSERT_EQUAL_MEMORY(&again, &pose, sizeof pose);
    }
}

/* ---- Bad frames ---------------------------------------------------------------------------------- */

/* Frames that are refused leave track and pose as they were, and the next ones do not see them. */
static void bad_frames_leave_no_trace(void)
{
    rng r = rng_seed(75);
    start();
    for (int n = 0; n < 30; n++) {
        see_turned(n);
        add_noise(&r, in, 3);
        memcpy(whole, in, sizeof in);
        TEST_ASSERT_EQUAL_INT(EDML_OK, run((uint32_t)n * FRAME));
        TEST_ASSERT_EQUAL_INT(EDML_OK, run_other((uint32_t)n * FRAME));
        TEST_ASSERT_EQUAL_MEMORY(&again, &pose, sizeof pose);
        const edml_track kept = track;
        in[n % EDML_JOINTS].y = n % 2 ? NAN : HUGE_VALF;
        TEST_ASSERT_EQUAL_INT(EDML_ERR_NOT_FINITE, run((uint32_t)n * FRAME + 10));
        for (int j = 0; j < EDML_JOINTS; j++) in[j].x = in[j].y = 7;
        TEST_ASSERT_EQUAL_INT(EDML_ERR_DEGENERATE, run((uint32_t)n * FRAME + 10));
        memcpy(in, whole, sizeof in);
        in[3].c = NAN;
        TEST_ASSERT_EQUAL_INT(EDML_ERR_NOT_FINITE, run((uint32_t)n * FRAME + 10));
        TEST_ASSERT_EQUAL_MEMORY(&kept, &track, sizeof track);
        TEST_ASSERT_EQUAL_MEMORY(&again, &pose, sizeof pose);
    }
}

/* A detection that is finite and absurd: whatever it gets, a second later all is well. */
static void an_absurd_frame_is_got_over(void)
{
    const float sizes[] = {1e-30F, 1e-6F, 1e6F, 1e18F, 1e25F, 1e37F};
    for (unsigned k = 0; k < sizeof sizes / sizeof *sizes; k++) {
        start();
        for (uint32_t n = 0; n < 100; n++) {
            see_turned((int)n);
            for (int j = 0; j < EDML_JOINTS && n == 20; j++) {
                in[j].x *= sizes[k] / 512;
                in[j].y *= sizes[k] / 512;
            }
            const edml_status status = run(n * FRAME);
            TEST_ASSERT_TRUE(all_finite(pose.joint, 3 * EDML_JOINTS));
            if (n < 20 || n > 55) TEST_ASSERT_EQUAL_INT(EDML_OK, status);
        }
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_lift(&again, in, NULL, &edml_direct_f32, &work, sizeof work));
        TEST_ASSERT_ERROR_UP_TO(0.1F, worst_joint_error(again.joint, pose.joint));
    }
}

/* Memory that was not kept well: the belief starts anew. */
static void a_belief_that_is_no_number_is_none(void)
{
    start();
    see_turned(0);
    TEST_ASSERT_EQUAL_INT(EDML_OK, run(0));
    track.arms_log_odds = track.legs_log_odds = track.mirror_log_odds = NAN;
    TEST_ASSERT_EQUAL_INT(EDML_OK, run(FRAME));
    TEST_ASSERT_TRUE(isfinite(track.arms_log_odds) && isfinite(track.legs_log_odds));
    TEST_ASSERT_TRUE(isfinite(track.mirror_log_odds) && all_finite(pose.joint, 3 * EDML_JOINTS));
}

/* ---- In integers --------------------------------------------------------------------------------- */

static edml_track_q track_q;
static edml_keypoint_q in_q[EDML_JOINTS];

/* Sides are swapped, joints are missing, and another person comes by and stays for a while. */
static void see_much(rng *r, int n)
{
    see_one_of_two(n, 40, 42);
    if (n >= 60) shift(400);
    add_noise(r, in, n % 40 < 20 ? 3 : 0);
    if (n >= 20 && n < 24) swap_detected(EDML_R_HIP);
    if (n >= 22 && n < 25) swap_detected(EDML_R_SHOULDER);
    if (n >= 30 && n < 45) in[EDML_L_WRIST].c = in[EDML_R_ANKLE].c = 0;
}

static int same_reports(void)
{
    return track.held == track_q.held && track.swapped == track_q.swapped &&
           track.mirrored == track_q.mirrored && track.leapt == track_q.leapt &&
           track.elapsed == track_q.elapsed && track.aside == track_q.aside;
}

static void integers_track_as_floats_do(void)
{
    static edml_work_q work_q;
    edml_pose_q pose_q, expected;
    rng r = rng_seed(77);
    start();
    edml_track_start_q(&track_q);
    for (int n = 0; n < 100; n++) {
        const uint32_t time = (uint32_t)n * FRAME;
        see_much(&r, n);
        to_q16(in_q, in);
        const float distance = edml_track_distance(&track, in, time);
        const int32_t distance_q = edml_track_distance_q(&track_q, in_q, time);
        TEST_ASSERT_EQUAL_INT(n == 0, distance == HUGE_VALF);
        TEST_ASSERT_EQUAL_INT(n == 0, distance_q == INT32_MAX);
        if (n > 0) TEST_ASSERT_FLOAT_WITHIN(0.001F, distance, (float)distance_q / 65536);
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_track_lift(&pose, &track, in, time, NULL, &edml_distances_w16,
                                                       &work, sizeof work));
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_track_lift_q(&pose_q, &track_q, in_q, time, NULL,
                                                         &edml_distances_w16, &work_q, sizeof work_q));
        TEST_ASSERT_TRUE(same_reports());
        TEST_ASSERT_EQUAL_UINT16(pose.seen, pose_q.seen);
        pose_to_q16(&expected, &pose);
        for (int j = 0; j < EDML_JOINTS; j++) {
            TEST_ASSERT_INT32_WITHIN(65536 / 200, expected.joint[j].x, pose_q.joint[j].x);
            TEST_ASSERT_INT32_WITHIN(65536 / 200, expected.joint[j].y, pose_q.joint[j].y);
            TEST_ASSERT_INT32_WITHIN(65536 / 200, expected.joint[j].z, pose_q.joint[j].z);
        }
        edml_track_swap_sides(in, &track);
        edml_track_swap_sides_q(in_q, &track_q);
        for (int j = 0; j < EDML_JOINTS; j++)
            TEST_ASSERT_FLOAT_WITHIN(0.001F, in[j].x, (float)in_q[j].x / 65536);
    }
}

/* Head and neck leap apart, faster than a rate can be: under 16384 pixels a second. */
static void rates_in_integers_have_an_end(void)
{
    static edml_work_q work_q;
    edml_pose_q pose_q;
    edml_track_start_q(&track_q);
    see_turned(0);
    for (uint32_t n = 0; n < 2; n++) {
        to_q16(in_q, in);
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_track_lift_q(&pose_q, &track_q, in_q, n, NULL,
                                                         &edml_distances_w16, &work_q, sizeof work_q));
        in[EDML_HEAD].x += 1000;
        in[EDML_NECK_BASE].x -= 1000;
    }
    /* of the end the gain of a millisecond: 4 Hz */
    const float most = 16384 * 0.0245F;
    TEST_ASSERT_FLOAT_WITHIN(2, most, (float)track_q.joint[EDML_HEAD].image.rate.x / 65536);
    TEST_ASSERT_FLOAT_WITHIN(2, -most, (float)track_q.joint[EDML_NECK_BASE].image.rate.x / 65536);
}

static void settings_in_integers_have_ranges(void)
{
    static edml_work_q work_q;
    static const edml_smoothing_q bad[] = {{0, 1}, {-1, 1}, {65536, -1}, {65536, 32 * 65536 + 1}};
    edml_pose_q pose_q;
    see_turned(0);
    to_q16(in_q, in);
    for (int n = 0; n < 8; n++) {
        edml_track_start_q(&track_q);
        *(n % 2 ? &track_q.smooth_image : &track_q.smooth_space) = bad[n / 2];
        TEST_ASSERT_EQUAL_INT(EDML_ERR_ARGUMENT,
                              edml_track_lift_q(&pose_q, &track_q, in_q, 0, NULL, &edml_distances_w16,
                                                &work_q, sizeof work_q));
    }
    edml_track_start_q(&track_q);
    track_q.noise_full = 64 * 65536 + 1;
    TEST_ASSERT_EQUAL_INT(
        EDML_ERR_ARGUMENT,
        edml_track_lift_q(&pose_q, &track_q, in_q, 0, NULL, &edml_distances_w16, &work_q, sizeof work_q));
}

static void a_track_that_was_not_started_and_bad_settings_are_refused(void)
{
    static const edml_smoothing bad[] = {{0, 1}, {-1, 1}, {NAN, 1}, {1, -1}, {1, NAN}, {1, INFINITY}};
    see_turned(0);
    memset(&track, 0, sizeof track);
    TEST_ASSERT_EQUAL_INT(EDML_ERR_ARGUMENT, run(0));
    memset(&track, 0xFF, sizeof track);
    TEST_ASSERT_EQUAL_INT(EDML_ERR_ARGUMENT, run(0));
    for (int n = 0; n < 6; n++) {
        start();
        track.smooth_image = bad[n];
        TEST_ASSERT_EQUAL_INT(EDML_ERR_ARGUMENT, run(0));
        start();
        track.smooth_space = bad[n];
        TEST_ASSERT_EQUAL_INT(EDML_ERR_ARGUMENT, run(0));
    }
    static const float bad_noise[] = {-1, NAN, INFINITY};
    for (int n = 0; n < 3; n++) {
        start();
        track.noise_full = bad_noise[n];
        TEST_ASSERT_EQUAL_INT(EDML_ERR_ARGUMENT, run(0));
    }
    start();
    TEST_ASSERT_EQUAL_INT(EDML_OK, run(0));
}

/* What is legal however large it is: a speed times the slope is beyond all floats. */
static void the_largest_settings_give_poses(void)
{
    static const float slopes[] = {5.2e36F, 1e38F, FLT_MAX};
    rng r = rng_seed(97);
    for (int n = 0; n < 3; n++) {
        start();
        track.smooth_image.slope = track.smooth_space.slope = slopes[n];
        track.smooth_image.cutoff = track.smooth_space.cutoff = n == 2 ? FLT_MIN : 1;
        for (int frame = 0; frame < 30; frame++) {
            see_turned(frame / 10);
            if (frame % 2) add_noise(&r, in, 3);
            TEST_ASSERT_EQUAL_INT(EDML_OK, run(33 * (uint32_t)frame));
            TEST_ASSERT_TRUE(all_finite(pose.joint, 3 * EDML_JOINTS));
            for (int j = 0; j < EDML_JOINTS; j++) TEST_ASSERT_TRUE(all_finite(&track.joint[j], 14));
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(somebody_who_stands_still_stays_as_lifted);
    RUN_TEST(the_hips_stay_opposite);
    RUN_TEST(the_image_may_be_of_any_size);
    RUN_TEST(noise_is_more_than_halved);
    RUN_TEST(the_filter_is_the_papers);
    RUN_TEST(motion_is_filtered_less_than_noise);
    RUN_TEST(motion_is_not_taken_for_noise);
    RUN_TEST(somebody_who_stands_still_does_not_tremble);
    RUN_TEST(without_filters_frames_are_as_lifted);
    RUN_TEST(swaps_are_undone);
    RUN_TEST(a_turn_is_not_undone);
    RUN_TEST(what_lasts_is_no_swap);
    RUN_TEST(a_mirror_image_is_taken_only_if_it_persists);
    RUN_TEST(a_missing_joint_is_held_for_300_ms);
    RUN_TEST(a_held_joint_moves_along);
    RUN_TEST(holding_does_not_make_up_a_person);
    RUN_TEST(the_distance_is_in_body_sizes);
    RUN_TEST(the_distance_forgives_what_detectors_do);
    RUN_TEST(the_distance_is_from_where_joints_are_expected);
    RUN_TEST(the_distance_is_huge_where_nothing_is_known);
    RUN_TEST(another_person_for_a_moment_leaves_no_trace);
    RUN_TEST(another_person_who_stays_is_followed);
    RUN_TEST(a_frame_that_shares_no_joint_is_of_another);
    RUN_TEST(a_walk_at_two_frames_a_second_is_no_leap);
    RUN_TEST(up_goes_to_the_lift);
    RUN_TEST(bad_up_leaves_no_trace);
    RUN_TEST(time_does_not_run_backwards);
    RUN_TEST(a_gap_starts_anew);
    RUN_TEST(the_clock_may_run_over_its_end);
    RUN_TEST(bad_frames_leave_no_trace);
    RUN_TEST(an_absurd_frame_is_got_over);
    RUN_TEST(a_belief_that_is_no_number_is_none);
    RUN_TEST(a_track_that_was_not_started_and_bad_settings_are_refused);
    RUN_TEST(the_largest_settings_give_poses);
    RUN_TEST(integers_track_as_floats_do);
    RUN_TEST(rates_in_integers_have_an_end);
    RUN_TEST(settings_in_integers_have_ranges);
    return UNITY_END();
}
