/* Prints a checksum of all that the library computes on hard input, in float and in fixed point: every
 * compiler, level of optimisation and processor must print what bits.txt has
 * (tests/python/test_bits.py).
 *
 * The input comes from integers and single float operations, so that it is the same as well.
 *
 * -DPARTS=N prints a part, so that it fits a small flash: 1 what distances lifts, 2 direct, 4 fconn, 8 the
 * rest, 16 videos.  -DPUBLIC leaves out what calls functions that a shared library does not export: the lines
 * that begin with fconv and equivariant.  -DBYTES prints at the end of how many bytes these are the checksums.
 *
 * SPDX-License-Identifier: MIT
 */
#include <string.h>
#ifndef __wasm__ /* which has no C library here: bits.mjs prints */
#include <stdio.h>
#endif

#include "edmlift.h"
#include "edmlift/angles.h"
#include "edmlift/body.h"
#include "edmlift/camera.h"
#include "edmlift/stages.h"
#include "edmlift/video.h"
#include "../support/equivariant_small.h"
#include "../support/fconv_tiny.h"
#include "number/real_f32.h" /* its input, too, is the same with fused operations switched on */

#ifndef PARTS
#define PARTS 31
#endif

enum { POSES = 200, MATRICES = 12, SHAPES = 12, STEPS = 6, NETS = 4, SMALL_NETS = 20 };

static edml_work work;
static edml_work_q work_q24;
static uint64_t hash; /* FNV-1a */
static uint32_t state;
static unsigned long bytes;

/* Adds words of 32 bits, or a shorter one, to the hash: the low byte of each first, wherever the processor has
 * it. */
static void add_words(const void *data, size_t size)
{
    static const uint16_t one = 1;
    const int low_first = *(const uint8_t *)&one;
    const uint8_t *byte = data;
    const size_t last = (size < 4 ? size : 4) - 1;
    for (size_t n = 0; n < size; n++) hash = (hash ^ byte[low_first ? n : n ^ last]) * 1099511628211U;
    bytes += (unsigned long)size;
}

/* A structure of words whose last member is shorter. */
#define ADD_WITH(last, structure)                                                                             \
    do {                                                                                                     \
        const uint8_t *const first = (const uint8_t *)&(structure);                                          \
        const uint32_t last_word = (structure).last;                                                         \
        add_words(first, (size_t)((const uint8_t *)&(structure).last - first));                              \
        add_words(&last_word, sizeof last_word);                                                             \
    } while (0)

/* An integer from 0 to below `range`. */
static int draw(int range)
{
    state = state * 1664525U + 1013904223U;
    return (int)((state >> 16) % (uint32_t)range);
}

/* From -1 to 1 in steps of 2^-10. */
static float draw_float(void) { return (float)(draw(2049) - 1024) / 1024.0F; }

/* A person whose every joint is off by up to a quarter of a metre; each fifth misses joints, a few
 * are upside down, equal, not finite or on a line. */
static void hard_pose(edml_keypoint in[EDML_JOINTS], int n)
{
    static const int8_t x[] = {0, 0, -18, -25, -22, 18, 27, 24, -13, -15, -16, 13, 15, 17};
    static const int8_t y[] = {-80, -56, -50, -23, -8, -50, -24, -12, 0, 42, 84, 0, 43, 85};
    const float size = (float)(1 + draw(500)) / 64.0F;
    for (int j = 0; j < EDML_JOINTS; j++) {
        in[j].x = 1000.0F + size * ((float)x[j] + 25.0F * draw_float());
        in[j].y = size * ((float)(n % 7 == 0 ? -y[j] : y[j]) + 25.0F * draw_float());
        in[j].c = n % 5 == 0 && draw(5) == 0 ? 0.0F : 1.0F;
        if (n % 50 == 49) in[j].y = in[0].y;
        if (n % 50 == 48) in[j].x = in[j].y;
    }
    if (n % 50 == 47) in[draw(EDML_JOINTS)].x /= 0.0F * in[0].c; /* infinity */
}

/* Any direction; every other pose has none. */
static const edml_point *some_up(int n)
{
    static edml_point up;
    up.x = draw_float();
    up.y = draw_float();
    up.z = draw_float();
    return n % 2 ? &up : NULL;
}

static const edml_point_q *some_up_q16(int n)
{
    static edml_point_q up;
    up.x = draw(2049) - 1024;
    up.y = draw(2049) - 1024;
    up.z = draw(2049) - 1024;
    return n % 2 ? &up : NULL;
}

static int lift_poses(const edml_model *model)
{
    int lifted = 0;
    for (int n = 0; n < POSES; n++) {
        edml_keypoint in[EDML_JOINTS];
        edml_pose pose;
        memset(&pose, 0, sizeof pose);
        hard_pose(in, n);
        const int8_t status = (int8_t)edml_lift(&pose, in, some_up(n), model, &work, sizeof work);
        add_words(&status, sizeof status);
        ADD_WITH(seen, pose);
        lifted += status == EDML_OK;
    }
    return lifted;
}

/* To Q16; what is out of range, its nearest end. */
static int32_t fixed(float pixels) { return pixels < 8192.0F ? (int32_t)(pixels * 65536.0F) : INT32_MAX; }

static void hard_pose_q16(edml_keypoint_q in[EDML_JOINTS], int n)
{
    edml_keypoint image[EDML_JOINTS];
    hard_pose(image, n);
    for (int j = 0; j < EDML_JOINTS; j++) {
        in[j].x = fixed(image[j].x);
        in[j].y = fixed(image[j].y);
        in[j].c = image[j].c > 0 ? INT16_MAX : 0;
    }
}

static int lift_poses_q24(const edml_model *model)
{
    int lifted = 0;
    for (int n = 0; n < POSES; n++) {
        edml_keypoint_q in[EDML_JOINTS];
        edml_pose_q pose;
        memset(&pose, 0, sizeof pose);
        hard_pose_q16(in, n);
        const int8_t status = (int8_t)edml_lift_q(&pose, in, some_up_q16(n), model, &work_q24,
                                                  sizeof work_q24);
        add_words(&status, sizeof status);
        ADD_WITH(seen, pose);
        lifted += status == EDML_OK;
    }
    return lifted;
}

/* Hard poses, lifted by cameras of many focal lengths, and placed before them. */
static int place_poses(void)
{
    int placed = 0;
    for (int n = 0; n < POSES; n++) {
        edml_keypoint in[EDML_JOINTS];
        edml_pose pose;
        edml_placement placement;
        memset(&placement, 0, sizeof placement);
        hard_pose(in, n);
        const float focal = (float)(500 + draw(2000));
        const edml_camera camera = {focal, focal, 1000, 0};
        if (edml_lift_with_camera(&pose, in, some_up(n), &camera, &edml_distances_f32, &work,
                                  sizeof work) != EDML_OK)
            continue;
        add_words(pose.joint, sizeof pose.joint);
        const int8_t status = (int8_t)edml_place(&placement, &pose, in, &camera, &work, sizeof work);
        add_words(&status, sizeof status);
        ADD_WITH(steps, placement);
        placed += status == EDML_OK;
    }
    return placed;
}

static int place_poses_q24(void)
{
    int placed = 0;
    for (int n = 0; n < POSES; n++) {
        edml_keypoint_q in[EDML_JOINTS];
        edml_pose_q pose;
        edml_placement_q placement;
        memset(&placement, 0, sizeof placement);
        hard_pose_q16(in, n);
        const int32_t focal = (500 + draw(2000)) * 65536;
        const edml_camera_q camera = {focal, focal, 1000 * 65536, 0};
        if (edml_lift_with_camera_q(&pose, in, some_up_q16(n), &camera, &edml_distances_w16, &work_q24,
                                    sizeof work_q24) != EDML_OK)
            continue;
        add_words(pose.joint, sizeof pose.joint);
        const int8_t status = (int8_t)edml_place_q(&placement, &pose, in, &camera, &work_q24,
                                                   sizeof work_q24);
        add_words(&status, sizeof status);
        ADD_WITH(steps, placement);
        placed += status == EDML_OK;
    }
    return placed;
}

/* What was lifted of hard poses: its quality, on the floor, and of people of many sizes. */
static int resize_poses(void)
{
    int resized = 0;
    for (int n = 0; n < POSES; n++) {
        edml_keypoint in[EDML_JOINTS];
        edml_pose pose;
        edml_point stood[EDML_JOINTS];
        edml_body owner = {1.5F + 0.75F * draw_float(), {0}};
        const edml_point up = {draw_float(), draw_float(), draw_float()};
        if (n % 3 == 0) owner.bone[draw(EDML_BONES)] = 0.3F + 0.0625F * draw_float();
        hard_pose(in, n);
        if (edml_lift(&pose, in, NULL, &edml_distances_f32, &work, sizeof work) != EDML_OK) continue;
        float quality = 0;
        edml_quality(&quality, &pose);
        add_words(&quality, sizeof quality);
        if (edml_stand(stood, &pose, up) == EDML_OK) add_words(stood, sizeof stood);
        const int8_t status = (int8_t)edml_fit_body(&pose, &owner);
        add_words(&status, sizeof status);
        add_words(pose.joint, sizeof pose.joint);
        resized += status == EDML_OK;
    }
    return resized;
}

static int resize_poses_q24(void)
{
    int resized = 0;
    for (int n = 0; n < POSES; n++) {
        edml_keypoint_q in[EDML_JOINTS];
        edml_pose_q pose;
        edml_point_q stood[EDML_JOINTS];
        edml_body_q owner = {49152 + 48 * draw(2049), {0}};
        const edml_point_q up = {draw(2049) - 1024, draw(2049) - 1024, draw(2049) - 1024};
        if (n % 3 == 0) owner.bone[draw(EDML_BONES)] = 16384 + 4 * draw(2049);
        hard_pose_q16(in, n);
        if (edml_lift_q(&pose, in, NULL, &edml_distances_w16, &work_q24, sizeof work_q24) != EDML_OK)
            continue;
        int32_t quality = 0;
        edml_quality_q(&quality, &pose);
        add_words(&quality, sizeof quality);
        if (edml_stand_q(stood, &pose, up) == EDML_OK) add_words(stood, sizeof stood);
        const int8_t status = (int8_t)edml_fit_body_q(&pose, &owner);
        add_words(&status, sizeof status);
        add_words(pose.joint, sizeof pose.joint);
        resized += status == EDML_OK;
    }
    return resized;
}

/* Angles of hard poses, lifted or made up, some of whose joints were not seen. */
static int measure_poses(void)
{
    int measured = 0;
    for (int n = 0; n < POSES; n++) {
        edml_keypoint in[EDML_JOINTS];
        edml_pose pose;
        float degrees[EDML_ANGLES];
        const edml_point *const up = some_up(n);
        hard_pose(in, n);
        if (edml_lift(&pose, in, NULL, &edml_distances_f32, &work, sizeof work) != EDML_OK) continue;
        for (int j = 0; j < EDML_JOINTS && n % 4 == 0; j++) pose.joint[j].z = draw_float();
        measured += edml_angles(degrees, &pose, up) == EDML_OK;
        for (int k = 0; k < EDML_ANGLES; k++) {
            const uint8_t there = degrees[k] >= -180; /* the bits of NaN are not the library's */
            add_words(&there, sizeof there);
            if (there) add_words(&degrees[k], sizeof degrees[k]);
        }
    }
    return measured;
}

static int measure_poses_q24(void)
{
    int measured = 0;
    for (int n = 0; n < POSES; n++) {
        edml_keypoint_q in[EDML_JOINTS];
        edml_pose_q pose;
        int32_t degrees[EDML_ANGLES];
        const edml_point_q *const up = some_up_q16(n);
        hard_pose_q16(in, n);
        if (edml_lift_q(&pose, in, NULL, &edml_distances_w16, &work_q24, sizeof work_q24) != EDML_OK)
            continue;
        for (int j = 0; j < EDML_JOINTS && n % 4 == 0; j++) pose.joint[j].z = 64 * (draw(2049) - 1024);
        measured += edml_angles_q(degrees, &pose, up) == EDML_OK;
        add_words(degrees, sizeof degrees);
    }
    return measured;
}

/* Hard poses as a video: their bones, measured and held; the focal length of all; and where they go. */
static int place_videos(void)
{
    int followed = 0;
    edml_measured_body measured;
    edml_focal focal;
    edml_path path;
    edml_measure_start(&measured);
    edml_focal_start(&focal, 2000, 1000);
    edml_path_start(&path);
    for (int n = 0; n < POSES; n++) {
        edml_keypoint in[EDML_JOINTS];
        edml_pose pose;
        edml_placement placement;
        edml_camera camera = {0, 0, 0, 0};
        memset(&placement, 0, sizeof placement);
        hard_pose(in, n);
        if (edml_lift(&pose, in, NULL, &edml_distances_f32, &work, sizeof work) != EDML_OK) continue;
        edml_measure_body(&measured, &pose);
        edml_fit_body(&pose, &measured.body);
        add_words(pose.joint, sizeof pose.joint);
        if (n % 4 == 0) edml_focal_add(&focal, &pose, in, &work, sizeof work);
        edml_focal_camera(&camera, &focal);
        add_words(&camera, sizeof camera);
        if (edml_place(&placement, &pose, in, &camera, &work, sizeof work) != EDML_OK) continue;
        const int8_t status = (int8_t)edml_path_follow(&path, &placement, (uint32_t)(40 * n));
        add_words(&status, sizeof status);
        add_words(&placement.translation, sizeof placement.translation);
        followed += status == EDML_OK;
    }
    add_words(measured.body.bone, sizeof measured.body.bone);
    add_words(focal.misfit, sizeof focal.misfit);
    return followed;
}

static int place_videos_q24(void)
{
    int followed = 0;
    edml_measured_body_q measured;
    edml_focal_q focal;
    edml_path_q path;
    edml_measure_start_q(&measured);
    edml_focal_start_q(&focal, 2000 * 65536, 1000 * 65536);
    edml_path_start_q(&path);
    for (int n = 0; n < POSES; n++) {
        edml_keypoint_q in[EDML_JOINTS];
        edml_pose_q pose;
        edml_placement_q placement;
        edml_camera_q camera = {0, 0, 0, 0};
        memset(&placement, 0, sizeof placement);
        hard_pose_q16(in, n);
        if (edml_lift_q(&pose, in, NULL, &edml_distances_w16, &work_q24, sizeof work_q24) != EDML_OK)
            continue;
        edml_measure_body_q(&measured, &pose);
        edml_fit_body_q(&pose, &measured.body);
        add_words(pose.joint, sizeof pose.joint);
        if (n % 4 == 0) edml_focal_add_q(&focal, &pose, in, &work_q24, sizeof work_q24);
        edml_focal_camera_q(&camera, &focal);
        add_words(&camera, sizeof camera);
        if (edml_place_q(&placement, &pose, in, &camera, &work_q24, sizeof work_q24) != EDML_OK) continue;
        const int8_t status = (int8_t)edml_path_follow_q(&path, &placement, (uint32_t)(40 * n));
        add_words(&status, sizeof status);
        add_words(&placement.translation, sizeof placement.translation);
        followed += status == EDML_OK;
    }
    add_words(measured.body.bone, sizeof measured.body.bone);
    add_words(focal.misfit, sizeof focal.misfit);
    return followed;
}

/* A frame of a video: someone who walks by, is seen with some noise, and misses a joint at times; some frames
 * have swapped legs, and some somebody else. */
static uint32_t video_frame(edml_keypoint in[EDML_JOINTS], int n)
{
    static const int8_t x[] = {0, 0, -18, -25, -22, 18, 27, 24, -13, -15, -16, 13, 15, 17};
    static const int8_t y[] = {-80, -56, -50, -23, -8, -50, -24, -12, 0, 42, 84, 0, 43, 85};
    for (int j = 0; j < EDML_JOINTS; j++) {
        const int from = n % 40 >= 35 && j >= EDML_R_HIP ? edml_mirror_joint[j] : j;
        const int swings = (j - 7) * (n % 30 < 15 ? n % 15 : 15 - n % 15);
        in[j].x = 300.0F + (float)(3 * n + 2 * x[from] + (n % 50 >= 48 ? 400 : 0)) + 4.0F * draw_float();
        in[j].y = 400.0F + 2.0F * (float)y[from] + (float)swings / 8.0F + 4.0F * draw_float();
        in[j].c = draw(16) == 0 ? 0.0F : 1.0F;
    }
    return (uint32_t)((n % 20 == 19 ? n - 1 : n) * 33 + n / 90 * 2000); /* some not later than the last */
}

static int track_poses(void)
{
    static edml_track track;
    int lifted = 0;
    edml_track_start(&track);
    for (int n = 0; n < POSES; n++) {
        edml_keypoint in[EDML_JOINTS];
        edml_pose pose;
        memset(&pose, 0, sizeof pose);
        const uint32_t time = video_frame(in, n);
        const float distance = edml_track_distance(&track, in, time);
        const int8_t status = (int8_t)edml_track_lift(&pose, &track, in, time, NULL, &edml_distances_f32,
                                                      &work, sizeof work);
        add_words(&distance, sizeof distance);
        add_words(&status, sizeof status);
        ADD_WITH(seen, pose);
        add_words(&track.swapped, sizeof track.swapped);
        lifted += status == EDML_OK;
    }
    return lifted;
}

static int track_poses_q24(void)
{
    static edml_track_q track;
    int lifted = 0;
    edml_track_start_q(&track);
    for (int n = 0; n < POSES; n++) {
        edml_keypoint image[EDML_JOINTS];
        edml_keypoint_q in[EDML_JOINTS];
        edml_pose_q pose;
        memset(&pose, 0, sizeof pose);
        const uint32_t time = video_frame(image, n);
        for (int j = 0; j < EDML_JOINTS; j++) {
            in[j].x = fixed(image[j].x);
            in[j].y = fixed(image[j].y);
            in[j].c = image[j].c > 0 ? INT16_MAX : 0;
        }
        const int32_t distance = edml_track_distance_q(&track, in, time);
        const int8_t status = (int8_t)edml_track_lift_q(&pose, &track, in, time, NULL, &edml_distances_w16,
                                                        &work_q24, sizeof work_q24);
        add_words(&distance, sizeof distance);
        add_words(&status, sizeof status);
        ADD_WITH(seen, pose);
        add_words(&track.swapped, sizeof track.swapped);
        lifted += status == EDML_OK;
    }
    return lifted;
}

/* Entries of both signs, of one size. */
static void decompose_matrices(void)
{
    static edml_matrix a;
    static edml_eigen e;
    for (int n = 0; n < MATRICES; n++) {
        for (int i = 0; i < EDML_JOINTS; i++)
            for (int j = i; j < EDML_JOINTS; j++) a.at[i][j] = draw_float();
        edml_jacobi(&e, &a);
        add_words(e.value, sizeof e.value);
        add_words(e.vector, sizeof e.vector);
    }
}

/* Distances that no points have, from 0 to 2 m. */
static void refine_shapes(void)
{
    for (int n = 0; n < SHAPES; n++) {
        edml_point x[EDML_JOINTS];
        float distance[EDML_PAIRS];
        for (int k = 0; k < EDML_PAIRS; k++) distance[k] = 1.0F + draw_float();
        edml_mds(x, distance, &work);
        add_words(x, sizeof x);
        const edml_objective objective = (edml_objective)(EDML_STRESS_SQUARE + n % 3);
        edml_refine(x, distance, objective, STEPS, &work);
        add_words(x, sizeof x);
    }
}

/* The same two, in integers. */
static void decompose_matrices_q24(void)
{
    static edml_matrix_q a;
    static edml_eigen_q e;
    for (int n = 0; n < MATRICES; n++) {
        for (int i = 0; i < EDML_JOINTS; i++)
            for (int j = i; j < EDML_JOINTS; j++) a.at[i][j] = (draw(2049) - 1024) * (1 << 14);
        edml_jacobi_q(&e, &a);
        add_words(e.value, sizeof e.value);
        add_words(e.vector, sizeof e.vector);
    }
}

static void refine_shapes_q24(void)
{
    for (int n = 0; n < SHAPES; n++) {
        edml_point_q24 x[EDML_JOINTS];
        int32_t distance[EDML_PAIRS];
        for (int k = 0; k < EDML_PAIRS; k++) distance[k] = draw(2049) * (1 << 14);
        edml_mds_q(x, distance, &work_q24);
        add_words(x, sizeof x);
        const edml_objective objective = (edml_objective)(EDML_STRESS_SQUARE + n % 3);
        edml_refine_q(x, distance, objective, STEPS, &work_q24);
        add_words(x, sizeof x);
    }
}

static void start(void)
{
    hash = 14695981039346656037U;
    state = 1;
}

#ifdef __wasm__
__attribute__((import_module("bits"), import_name("print"))) void
print_line(const char *what, const char *model, uint32_t high, uint32_t low, int count, int of, const char *done);
#else
static void print_line(const char *what, const char *model, uint32_t high, uint32_t low, int count, int of,
                       const char *done)
{
    printf("%s%s %08lx%08lx %d of %d %s\n", what, model, (unsigned long)high, (unsigned long)low, count, of,
           done);
}
#endif

static void report_of(const char *what, const char *model, int count, int of, const char *done)
{
    print_line(what, model, (uint32_t)(hash >> 32), (uint32_t)hash, count, of, done);
}

static void report(const char *what, int count, const char *done) { report_of(what, "", count, POSES, done); }

static void report_lifts(const edml_model *f32, const edml_model *w16, const edml_model *w8)
{
    const edml_model *const models[] = {f32, w16, w16, w8};
    for (int n = 0; n < 4; n++) {
        start();
        const int lifted = n < 2 ? lift_poses(models[n]) : lift_poses_q24(models[n]);
        report_of(n < 2 ? "float " : "fixed ", edml_model_name(models[n]), lifted, POSES, "lifted");
    }
}

static void report_the_rest(void)
{
    start();
    decompose_matrices();
    refine_shapes();
    report_of("float", "", MATRICES + SHAPES, MATRICES + SHAPES, "computed");
    start();
    decompose_matrices_q24();
    refine_shapes_q24();
    report_of("fixed", "", MATRICES + SHAPES, MATRICES + SHAPES, "computed");
    start();
    report("float", place_poses(), "placed");
    start();
    report("fixed", place_poses_q24(), "placed");
    start();
    report("float", resize_poses(), "resized");
    start();
    report("fixed", resize_poses_q24(), "resized");
    start();
    report("float", measure_poses(), "measured");
    start();
    report("fixed", measure_poses_q24(), "measured");
}

#ifndef PUBLIC
/* The distances that the small FConv of fconv_tiny.h predicts. */
static int convolve(const edml_model *model)
{
    static edml_fconv_work fconv_work;
    for (int n = 0; n < NETS; n++) {
        edml_image image = {{{0, 0}}, {0, 1}, (1 << EDML_JOINTS) - 1};
        edml_prediction said;
        for (int j = 0; j < EDML_JOINTS; j++) {
            image.at[j].u = draw_float();
            image.at[j].v = 2.0F * draw_float();
        }
        edml_predict(&said, &image, NULL, model, &fconv_work, sizeof fconv_work);
        add_words(said.distance, sizeof said.distance);
    }
    return NETS;
}

/* What small equivariant networks give, in float and in integers of these weights; every third input is zero. */
static int run_in_float(void)
{
    float values[EDML_MAX_VALUES];
    for (int n = 0; n < SMALL_NETS; n++) {
        const edml_model model = small_equivariant(small_layers_f32, draw);
        for (int k = 0; k < SMALL_INPUTS; k++) values[k] = k % 3 == 0 ? 0.0F : 3.0F * draw_float();
        edml__equivariant_f32(values, values, &model, &work.of.network.units);
        add_words(values, 2 * SMALL_ROWS * sizeof *values);
    }
    return SMALL_NETS;
}

static int run_in_integers(const void *layers)
{
    int32_t values[EDML_MAX_VALUES];
    for (int n = 0; n < SMALL_NETS; n++) {
        const edml_model model = small_equivariant(layers, draw);
        for (int k = 0; k < SMALL_INPUTS; k++) values[k] = k % 3 == 0 ? 0 : (draw(65536) - 32768) * 4096;
        if (layers == small_layers_w16)
            edml__equivariant_w16(values, values, &model, &work_q24.of.network.units);
        else
            edml__equivariant_w8(values, values, &model, &work_q24.of.network.units);
        add_words(values, 2 * SMALL_ROWS * sizeof *values);
    }
    return SMALL_NETS;
}

static void report_small_networks(void)
{
    start();
    report_of("equivariant ", "f32", run_in_float(), SMALL_NETS, "computed");
    start();
    report_of("equivariant ", "w16", run_in_integers(small_layers_w16), SMALL_NETS, "computed");
    start();
    report_of("equivariant ", "w8", run_in_integers(small_layers_w8), SMALL_NETS, "computed");
    const edml_model f32 = tiny_f32(), w8 = tiny_w8();
    start();
    report_of("fconv ", "f32", convolve(&f32), NETS, "computed");
    start();
    report_of("fconv ", "w8", convolve(&w8), NETS, "computed");
}
#endif

static void report_videos(void)
{
    start();
    report("float video", place_videos(), "placed");
    start();
    report("fixed video", place_videos_q24(), "placed");
    start();
    report("float", track_poses(), "tracked");
    start();
    report("fixed", track_poses_q24(), "tracked");
}

int main(void)
{
    if (PARTS & 1) report_lifts(&edml_distances_f32, &edml_distances_w16, &edml_distances_w8);
    if (PARTS & 2) report_lifts(&edml_direct_f32, &edml_direct_w16, &edml_direct_w8);
    if (PARTS & 4) report_lifts(&edml_fconn_f32, &edml_fconn_w16, &edml_fconn_w8);
    if (PARTS & 8) report_the_rest();
#ifndef PUBLIC
    if (PARTS & 8) report_small_networks();
#endif
    if (PARTS & 16) report_videos();
#ifdef BYTES
    printf("%lu bytes\n", bytes);
#endif
    return 0;
}
