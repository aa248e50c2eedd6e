/* The error contract of include/edmlift.h, for every public function that returns a status: what it refuses, and
 * that a call which fails writes nothing but work memory.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>
#include <stdlib.h>

#include "native.h"
#include "network/model.h" /* to make models that no lift can run */

/* ---- Calls: their arguments, and the memory that these point to ----------------------------------------- */

enum {
    POSE,
    IN,
    MODEL,
    WORK,
    UP,
    IMAGE,
    PREDICTION,
    POINTS,
    PLACEMENT,
    CAMERA,
    BODY,
    QUALITY,
    COUNT,
    STOOD,
    DEGREES,
    TRACK,
    PATH,
    FOCAL,
    MEASURED,
    MILLIMETRES,
    POINTERS,
    NONE = -1
};

static void *pointer[POINTERS];
static size_t work_bytes;
static pixels width, height;
static uint32_t time_ms;
static uint16_t seen;

/* All that a call could change, but for work memory. */
static struct {
    edml_pose pose;
    edml_keypoint in[EDML_JOINTS];
    edml_model model;
    edml_point up;
    edml_image image;
    edml_prediction prediction;
    point points[EDML_JOINTS], upwards;
    edml_placement placement;
    edml_camera camera;
    edml_body body;
    api_real quality;
    int count;
    edml_point stood[EDML_JOINTS];
    api_real degrees[EDML_ANGLES];
    edml_track track;
    edml_path path;
    edml_focal focal;
    edml_measured_body measured;
    uint8_t millimetres[EDML_JOINTS];
} memory, before;

static edml_fconv_work work;

static edml_status call_lift(void)
{
    return edml_lift(pointer[POSE], pointer[IN], pointer[UP], pointer[MODEL], pointer[WORK], work_bytes);
}

static edml_status call_lift_with_camera(void)
{
    return edml_lift_with_camera(pointer[POSE], pointer[IN], pointer[UP], pointer[CAMERA], pointer[MODEL],
                                 pointer[WORK], work_bytes);
}

static edml_status call_body_frame(void)
{
    return edml_body_frame(pointer[IMAGE], pointer[IN], 10, &edml_default_imputation);
}

static edml_status call_predict(void)
{
    return edml_predict(pointer[PREDICTION], pointer[IMAGE], &memory.upwards, pointer[MODEL], pointer[WORK],
                        work_bytes);
}

static edml_status call_orient(void) { return edml_orient(pointer[POINTS], pointer[IMAGE]); }

static edml_status call_place(void)
{
    return edml_place(pointer[PLACEMENT], pointer[POSE], pointer[IN], pointer[CAMERA], pointer[WORK],
                      work_bytes);
}

static edml_status call_place_sweep(void)
{
    return edml_place_sweep(pointer[PLACEMENT], pointer[CAMERA], pointer[POSE], pointer[IN], width, height,
                            pointer[WORK], work_bytes);
}

static edml_status call_path_follow(void)
{
    return edml_path_follow(pointer[PATH], pointer[PLACEMENT], time_ms);
}

static edml_status call_focal_start(void) { return edml_focal_start(pointer[FOCAL], width, height); }

static edml_status call_focal_add(void)
{
    return edml_focal_add(pointer[FOCAL], pointer[POSE], pointer[IN], pointer[WORK], work_bytes);
}

static edml_status call_focal_camera(void) { return edml_focal_camera(pointer[CAMERA], pointer[FOCAL]); }

static edml_status call_measure_body(void) { return edml_measure_body(pointer[MEASURED], pointer[POSE]); }

static edml_status call_fit_body(void) { return edml_fit_body(pointer[POSE], pointer[BODY]); }

static edml_status call_quality(void) { return edml_quality(pointer[QUALITY], pointer[POSE]); }

static edml_status call_joint_limits(void) { return edml_joint_limits(pointer[COUNT], pointer[POSE]); }

static edml_status call_reflect(void)
{
    return edml_reflect_by_joint_limits(pointer[COUNT], pointer[POSE]);
}

static edml_status call_stand(void) { return edml_stand(pointer[STOOD], pointer[POSE], memory.up); }

static edml_status call_angles(void) { return edml_angles(pointer[DEGREES], pointer[POSE], pointer[UP]); }

static edml_status call_track_lift(void)
{
    return edml_track_lift(pointer[POSE], pointer[TRACK], pointer[IN], time_ms, pointer[UP], pointer[MODEL],
                           pointer[WORK], work_bytes);
}

#ifndef EDML_TEST_Q24 /* in float alone */

static edml_status call_uncertainty(void) { return edml_uncertainty(pointer[MILLIMETRES], seen); }

static edml_status call_model_check(void) { return edml_model_check(pointer[MODEL]); }

#endif

typedef struct {
    const char *name;
    edml_status (*run)(void);
    int argument[6]; /* its pointers, but for `up`, which may be NULL; NONE behind them */
} function;

static const function functions[] = {
    {"edml_lift", call_lift, {POSE, IN, MODEL, WORK, NONE}},
    {"edml_lift_with_camera", call_lift_with_camera, {POSE, IN, CAMERA, MODEL, WORK, NONE}},
    {"edml_body_frame", call_body_frame, {IMAGE, IN, NONE}},
    {"edml_predict", call_predict, {PREDICTION, IMAGE, MODEL, WORK, NONE}},
    {"edml_orient", call_orient, {POINTS, IMAGE, NONE}},
    {"edml_place", call_place, {PLACEMENT, POSE, IN, CAMERA, WORK, NONE}},
    {"edml_place_sweep", call_place_sweep, {PLACEMENT, CAMERA, POSE, IN, WORK, NONE}},
    {"edml_path_follow", call_path_follow, {PATH, PLACEMENT, NONE}},
    {"edml_focal_start", call_focal_start, {FOCAL, NONE}},
    {"edml_focal_add", call_focal_add, {FOCAL, POSE, IN, WORK, NONE}},
    {"edml_focal_camera", call_focal_camera, {CAMERA, FOCAL, NONE}},
    {"edml_measure_body", call_measure_body, {MEASURED, POSE, NONE}},
    {"edml_fit_body", call_fit_body, {POSE, BODY, NONE}},
    {"edml_quality", call_quality, {QUALITY, POSE, NONE}},
    {"edml_joint_limits", call_joint_limits, {COUNT, POSE, NONE}},
    {"edml_reflect_by_joint_limits", call_reflect, {COUNT, POSE, NONE}},
    {"edml_stand", call_stand, {STOOD, POSE, NONE}},
    {"edml_angles", call_angles, {DEGREES, POSE, NONE}},
    {"edml_track_lift", call_track_lift, {POSE, TRACK, IN, MODEL, WORK, NONE}},
#ifndef EDML_TEST_Q24
    {"edml_uncertainty", call_uncertainty, {MILLIMETRES, NONE}},
    {"edml_model_check", call_model_check, {MODEL, NONE}},
#endif
};
enum { FUNCTIONS = sizeof functions / sizeof functions[0] };

static int takes(const function *f, int argument)
{
    for (int n = 0; f->argument[n] != NONE; n++)
        if (f->argument[n] == argument) return 1;
    return 0;
}

static void point_to_memory(void)
{
    pointer[POSE] = &memory.pose;
    pointer[IN] = memory.in;
    pointer[MODEL] = &memory.model;
    pointer[WORK] = &work;
    pointer[UP] = &memory.up;
    pointer[IMAGE] = &memory.image;
    pointer[PREDICTION] = &memory.prediction;
    pointer[POINTS] = memory.points;
    pointer[PLACEMENT] = &memory.placement;
    pointer[CAMERA] = &memory.camera;
    pointer[BODY] = &memory.body;
    pointer[QUALITY] = &memory.quality;
    pointer[COUNT] = &memory.count;
    pointer[STOOD] = memory.stood;
    pointer[DEGREES] = memory.degrees;
    pointer[TRACK] = &memory.track;
    pointer[PATH] = &memory.path;
    pointer[FOCAL] = &memory.focal;
    pointer[MEASURED] = &memory.measured;
    pointer[MILLIMETRES] = memory.millimetres;
    work_bytes = sizeof work;
}

/* A track and a path that go on, a placement 4 m away, an image of a pose, and a body of one. */
static void prepare_video(void)
{
    edml_track_start(&memory.track);
    time_ms = 100;
    edml_path_start(&memory.path);
    memset(&memory.placement, 0, sizeof memory.placement);
    memory.placement.translation.z = TO_API(REAL(4.0));
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_path_follow(&memory.path, &memory.placement, time_ms - 33));
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_focal_start(&memory.focal, width, height));
    memory.focal.poses = 1;
    edml_measure_start(&memory.measured);
}

/* Arguments with which every function succeeds. */
static void prepare(const edml_model *model)
{
    point_f32 x[EDML_JOINTS];
    keypoint_f32 image[EDML_JOINTS];
    const edml_camera camera = {to_pixels(1145), to_pixels(1145), to_pixels(500), to_pixels(400)};
    memset(&memory, 0x5A, sizeof memory);
    memset(&memory.body, 0, sizeof memory.body);
    human_pose(x);
    photograph(image, x);
    to_keypoints(memory.in, image);
    to_points(memory.points, x);
    memory.model = *model;
    memory.camera = camera;
    memory.body.height = TO_API(REAL(1.75));
    width = to_pixels(1000);
    height = to_pixels(800);
    memory.up.x = memory.up.z = 0;
    memory.up.y = TO_API(-REAL(1.0));
    memory.upwards.x = memory.upwards.z = 0;
    memory.upwards.y = -REAL(1.0);
    prepare_video();
    seen = ALL_SEEN;
    point_to_memory();
    TEST_ASSERT_EQUAL_INT(EDML_OK, call_body_frame());
    TEST_ASSERT_EQUAL_INT(EDML_OK, call_lift());
}

static void check_failure(const function *f, edml_status expected, const char *why)
{
    char message[96];
    snprintf(message, sizeof message, "%s: %s", f->name, why);
    memcpy(&before, &memory, sizeof before);
    TEST_ASSERT_EQUAL_STRING_MESSAGE(edml_status_name(expected), edml_status_name(f->run()), message);
    TEST_ASSERT_EQUAL_MEMORY_MESSAGE(&before, &memory, sizeof before, message);
}

/* ---- Pointers ------------------------------------------------------------------------------------------- */

static void every_function_succeeds_with_these_arguments(void)
{
    for (int n = 0; n < FUNCTIONS; n++) {
        for (int known = 0; known < 2; known++) {
            prepare(&DISTANCES);
            if (!known) pointer[UP] = NULL;
            TEST_ASSERT_EQUAL_INT_MESSAGE(EDML_OK, functions[n].run(), functions[n].name);
        }
    }
}

static void null_is_refused(void)
{
    for (int n = 0; n < FUNCTIONS; n++) {
        for (int k = 0; functions[n].argument[k] != NONE; k++) {
            prepare(&FCONN);
            pointer[functions[n].argument[k]] = NULL;
            check_failure(&functions[n], EDML_ERR_ARGUMENT, "null");
        }
    }
}

static void misaligned_work_memory_is_refused(void)
{
    for (int n = 0; n < FUNCTIONS; n++) {
        if (!takes(&functions[n], WORK)) continue;
        for (int by = 1; by < 4; by++) {
            prepare(&FCONN);
            pointer[WORK] = (char *)&work + by;
            work_bytes = sizeof work - 4;
            check_failure(&functions[n], EDML_ERR_ARGUMENT, "misaligned");
        }
    }
}

/* ---- Work memory ---------------------------------------------------------------------------------------- */

#ifndef EDML_TEST_Q24
static const edml_model *const models[] = {&edml_direct_f32,    &edml_direct_w16,    &edml_direct_w8,
                                           &edml_distances_f32, &edml_distances_w16, &edml_distances_w8,
                                           &edml_fconn_f32,     &edml_fconn_w16,     &edml_fconn_w8,
                                           &edml_fconv_f32,     &edml_fconv_w8};
#else
static const edml_model *const models[] = {&edml_direct_w16,   &edml_direct_w8, &edml_distances_w16,
                                           &edml_distances_w8, &edml_fconn_w16, &edml_fconn_w8,
                                           &edml_fconv_w8};
#endif
enum { MODELS = sizeof models / sizeof models[0] };

static size_t bytes_needed(const function *f, const edml_model *model)
{
    return takes(f, MODEL) ? edml_model_work_bytes(model) : sizeof(edml_work);
}

static void one_byte_too_few_is_refused(void)
{
    for (int n = 0; n < FUNCTIONS; n++) {
        if (!takes(&functions[n], WORK)) continue;
        for (int m = 0; m < MODELS; m++) {
            prepare(models[m]);
            work_bytes = bytes_needed(&functions[n], models[m]) - 1;
            check_failure(&functions[n], EDML_ERR_WORK_TOO_SMALL, "one byte too few");
            work_bytes = 0;
            check_failure(&functions[n], EDML_ERR_WORK_TOO_SMALL, "none at all");
        }
    }
}

/* On the heap, so that the sanitizer sees a byte beyond. */
static void just_enough_is_enough(void)
{
    for (int n = 0; n < FUNCTIONS; n++) {
        if (!takes(&functions[n], WORK)) continue;
        for (int m = 0; m < MODELS; m++) {
            const size_t bytes = bytes_needed(&functions[n], models[m]);
            void *const enough = malloc(bytes);
            TEST_ASSERT_NOT_NULL(enough);
            prepare(models[m]);
            pointer[WORK] = enough;
            work_bytes = bytes;
            const edml_status status = functions[n].run();
            free(enough);
            TEST_ASSERT_EQUAL_INT_MESSAGE(EDML_OK, status, functions[n].name);
        }
    }
}

static void models_say_how_much_they_need(void)
{
    for (int m = 0; m < MODELS; m++) {
        const int fconv = edml_model_work_bytes(models[m]) > sizeof(edml_work);
        TEST_ASSERT_EQUAL_INT(strncmp(edml_model_name(models[m]), "fconv", 5) == 0, fconv);
        TEST_ASSERT_TRUE(edml_model_work_bytes(models[m]) <= (fconv ? sizeof work : sizeof(edml_work)));
        TEST_ASSERT_TRUE(edml_model_work_bytes(models[m]) % 4 == 0);
    }
}

/* ---- Models --------------------------------------------------------------------------------------------- */

/* Does a call run the model? */
static int runs_model(const function *f) { return takes(f, MODEL) && takes(f, WORK); }

/* What the stages have a use for: distances of distances; points and gates of the body's coordinates, with
 * distances or without. */
static int is_known(int reads, int gives)
{
    if (!(reads & EDML_READS_BODY)) return reads == EDML_READS_DISTANCES && gives == EDML_GIVES_DISTANCES;
    return reads < 4 &&
           (gives | EDML_GIVES_DISTANCES) == (EDML_GIVES_DISTANCES | EDML_GIVES_POINTS | EDML_GIVES_GATES);
}

static void a_model_that_reads_or_gives_something_else_is_refused(void)
{
    static const int some[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 15, 16, 64, 128, 255};
    enum { SOME = sizeof some / sizeof *some };
    for (int n = 0; n < FUNCTIONS; n++) {
        if (!runs_model(&functions[n])) continue;
        for (int k = 0; k < SOME * SOME; k++) {
            const int reads = some[k / SOME], gives = some[k % SOME];
            if (is_known(reads, gives)) continue;
            prepare(&DISTANCES);
            memory.model.reads = (uint8_t)reads;
            memory.model.gives = (uint8_t)gives;
            check_failure(&functions[n], EDML_ERR_MODEL, "reads or gives");
        }
    }
}

/* Of distances the lift makes points by what the model names. */
static void distances_without_what_scales_them_are_refused(void)
{
    for (int n = 0; n < FUNCTIONS; n++) {
        if (!runs_model(&functions[n]) || functions[n].run == call_predict) continue;
        prepare(n % 2 ? &FCONN : &DISTANCES);
        memory.model.scale_f32 = NULL;
        memory.model.scale_q = NULL;
        check_failure(&functions[n], EDML_ERR_MODEL, "nothing scales");
    }
}

static void a_model_that_this_arithmetic_cannot_run_is_refused(void)
{
    for (int n = 0; n < FUNCTIONS; n++) {
        if (!runs_model(&functions[n])) continue;
        prepare(&FCONN);
        memory.model.work_bytes = memory.model.work_bytes_q = 0;
        check_failure(&functions[n], EDML_ERR_MODEL, "no work memory");
        TEST_ASSERT_TRUE(edml_model_work_bytes(&memory.model) == 0);
#ifdef EDML_TEST_Q24
        static const edml_model *const float_models[] = {&edml_direct_f32, &edml_distances_f32,
                                                         &edml_fconn_f32, &edml_fconv_f32};
        for (int m = 0; m < 4; m++) {
            prepare(&FCONN);
            memory.model = *float_models[m];
            check_failure(&functions[n], EDML_ERR_MODEL, "a float model");
            TEST_ASSERT_TRUE(edml_model_work_bytes(float_models[m]) == 0);
        }
#endif
    }
}

/* ---- Faults of the input -------------------------------------------------------------------------------- */

#ifndef EDML_TEST_Q24
#define NO_NUMBER NAN
#else
#define NO_NUMBER (1 << 29) /* an end of the range */
#endif

static void keypoint_is_no_number(void) { memory.in[3].x = NO_NUMBER; }

static void six_joints_seen(void)
{
    for (int j = 0; j < EDML_JOINTS - 6; j++) memory.in[j].c = 0;
    seen = ALL_SEEN >> 5;
}

static void keypoints_are_a_point(void)
{
    for (int j = 0; j < EDML_JOINTS; j++) memory.in[j].x = memory.in[j].y = to_pixels(300);
}

static void image_is_a_point(void)
{
    for (int j = 0; j < EDML_JOINTS; j++) memory.image.at[j].u = memory.image.at[j].v = REAL(0.5);
}

static void image_has_no_joints(void) { memory.image.seen = 0; }

static void pose_lacks_joints(void) { memory.pose.seen = ALL_SEEN >> 5; }

static void pose_is_out_of_reach(void) { memory.pose.joint[5].y = TO_API(REAL(4.5)); }

static void pose_is_a_point(void) { memset(memory.pose.joint, 0, sizeof memory.pose.joint); }

static void pose_is_of_no_lift(void) { memory.pose.misfit = TO_API(-REAL(1.0)); }

static void points_are_a_point(void) { memset(memory.points, 0, sizeof memory.points); }

static void camera_is_none(void) { memory.camera.fx = width = 0; }

static void body_is_none(void) { memory.body.height = TO_API(REAL(3.5)); }

static void camera_is_too_narrow(void) { memory.camera.fx = memory.camera.fy = to_pixels(100); }

static void image_has_no_size(void) { memory.focal.width = 0; }

static void search_has_no_pose(void) { memory.focal.poses = 0; }

static void placement_is_out_of_reach(void) { memory.placement.joint[3].x = TO_API(REAL(121.0)); }

static void placement_is_far_away(void) { memory.placement.translation.z = TO_API(REAL(101.0)); }

static void placement_comes_late(void) { memory.path.time = time_ms; }

static void up_is_zero(void) { memory.up.y = 0; }

static void up_is_no_number(void) { memory.up.x = NO_NUMBER; }

#ifndef EDML_TEST_Q24
static void model_is_damaged(void) { memory.model.checksum ^= 1; }
#endif

static void frame_comes_late(void)
{
    memory.track.started = 1;
    memory.track.time = time_ms + 1;
}

static void track_was_not_started(void) { memset(&memory.track, 0, sizeof memory.track); }

static const struct {
    const char *name;
    void (*put_in)(void);
    struct {
        edml_status (*call)(void);
        edml_status status;
    } expected[10];
} faults[] = {
    {"a keypoint that is no number",
     keypoint_is_no_number,
     {
         {call_lift, EDML_ERR_NOT_FINITE},
         {call_lift_with_camera, EDML_ERR_NOT_FINITE},
         {call_body_frame, EDML_ERR_NOT_FINITE},
         {call_place, EDML_ERR_NOT_FINITE},
         {call_place_sweep, EDML_ERR_NOT_FINITE},
         {call_focal_add, EDML_ERR_NOT_FINITE},
         {call_track_lift, EDML_ERR_NOT_FINITE},
     }},
    {"six joints seen",
     six_joints_seen,
     {
         {call_lift, EDML_ERR_TOO_FEW_JOINTS},
         {call_lift_with_camera, EDML_ERR_TOO_FEW_JOINTS},
         {call_body_frame, EDML_ERR_TOO_FEW_JOINTS},
         {call_place, EDML_ERR_TOO_FEW_JOINTS},
         {call_place_sweep, EDML_ERR_TOO_FEW_JOINTS},
         {call_focal_add, EDML_ERR_TOO_FEW_JOINTS},
         {call_track_lift, EDML_ERR_TOO_FEW_JOINTS},
#ifndef EDML_TEST_Q24
         {call_uncertainty, EDML_ERR_TOO_FEW_JOINTS},
#endif
     }},
    {"keypoints that are a point",
     keypoints_are_a_point,
     {
         {call_lift, EDML_ERR_DEGENERATE},
         {call_lift_with_camera, EDML_ERR_DEGENERATE},
         {call_body_frame, EDML_ERR_DEGENERATE},
         {call_place, EDML_ERR_DEGENERATE},
         {call_place_sweep, EDML_ERR_DEGENERATE},
         {call_focal_add, EDML_ERR_DEGENERATE},
         {call_track_lift, EDML_ERR_DEGENERATE},
     }},
    {"an image that is a point", image_is_a_point, {{call_orient, EDML_ERR_DEGENERATE}}},
    {"an image without joints", image_has_no_joints, {{call_orient, EDML_ERR_DEGENERATE}}},
    {"a pose that lacks joints", pose_lacks_joints, {{call_quality, EDML_ERR_TOO_FEW_JOINTS}}},
    {"a pose out of reach",
     pose_is_out_of_reach,
     {{call_place, EDML_ERR_NOT_FINITE},
      {call_place_sweep, EDML_ERR_NOT_FINITE},
      {call_focal_add, EDML_ERR_NOT_FINITE},
      {call_measure_body, EDML_ERR_NOT_FINITE},
      {call_fit_body, EDML_ERR_NOT_FINITE},
      {call_quality, EDML_ERR_NOT_FINITE},
      {call_joint_limits, EDML_ERR_NOT_FINITE},
      {call_reflect, EDML_ERR_NOT_FINITE},
      {call_stand, EDML_ERR_NOT_FINITE},
      {call_angles, EDML_ERR_NOT_FINITE}}},
    {"a pose that is a point",
     pose_is_a_point,
     {{call_place, EDML_ERR_DEGENERATE},
      {call_place_sweep, EDML_ERR_DEGENERATE},
      {call_focal_add, EDML_ERR_DEGENERATE},
      {call_measure_body, EDML_ERR_DEGENERATE},
      {call_fit_body, EDML_ERR_DEGENERATE}}},
    {"a pose of no lift", pose_is_of_no_lift, {{call_quality, EDML_ERR_ARGUMENT}}},
    {"points that are a point", points_are_a_point, {{call_orient, EDML_ERR_DEGENERATE}}},
    {"no camera",
     camera_is_none,
     {{call_place, EDML_ERR_CAMERA},
      {call_place_sweep, EDML_ERR_CAMERA},
      {call_focal_start, EDML_ERR_CAMERA},
      {call_lift_with_camera, EDML_ERR_CAMERA}}},
    {"a camera that cannot have seen this",
     camera_is_too_narrow,
     {{call_place, EDML_ERR_CAMERA}, {call_lift_with_camera, EDML_ERR_CAMERA}}},
    {"a search without an image",
     image_has_no_size,
     {{call_focal_add, EDML_ERR_CAMERA}, {call_focal_camera, EDML_ERR_CAMERA}}},
    {"a search without a pose", search_has_no_pose, {{call_focal_camera, EDML_ERR_CAMERA}}},
    {"a placement out of reach", placement_is_out_of_reach, {{call_path_follow, EDML_ERR_NOT_FINITE}}},
    {"a placement too far away", placement_is_far_away, {{call_path_follow, EDML_ERR_CAMERA}}},
    {"a placement that comes late", placement_comes_late, {{call_path_follow, EDML_ERR_TIME}}},
    {"no body", body_is_none, {{call_fit_body, EDML_ERR_BODY}}},
    {"no way up",
     up_is_zero,
     {
         {call_stand, EDML_ERR_DEGENERATE},
         {call_angles, EDML_ERR_DEGENERATE},
         {call_lift, EDML_ERR_DEGENERATE},
         {call_lift_with_camera, EDML_ERR_DEGENERATE},
         {call_track_lift, EDML_ERR_DEGENERATE},
     }},
    {"up that is no number",
     up_is_no_number,
     {
         {call_stand, EDML_ERR_NOT_FINITE},
         {call_angles, EDML_ERR_NOT_FINITE},
         {call_lift, EDML_ERR_NOT_FINITE},
         {call_lift_with_camera, EDML_ERR_NOT_FINITE},
         {call_track_lift, EDML_ERR_NOT_FINITE},
     }},
#ifndef EDML_TEST_Q24
    {"a damaged model", model_is_damaged, {{call_model_check, EDML_ERR_MODEL}}},
#endif
    {"a frame that comes late", frame_comes_late, {{call_track_lift, EDML_ERR_TIME}}},
    {"a track that was not started", track_was_not_started, {{call_track_lift, EDML_ERR_ARGUMENT}}},
};
enum { FAULTS = sizeof faults / sizeof faults[0] };

/* A fault that is not in a function's list does not make it fail. */
static edml_status expected_status(int fault, const function *f)
{
    for (int k = 0; k < 10 && faults[fault].expected[k].call != NULL; k++)
        if (faults[fault].expected[k].call == f->run) return faults[fault].expected[k].status;
    return EDML_OK;
}

static void every_fault_has_its_status_and_leaves_no_trace(void)
{
    for (int fault = 0; fault < FAULTS; fault++) {
        for (int n = 0; n < FUNCTIONS; n++) {
            const edml_status expected = expected_status(fault, &functions[n]);
            prepare(n % 2 ? &DISTANCES : &DIRECT);
            faults[fault].put_in();
            if (expected != EDML_OK) check_failure(&functions[n], expected, faults[fault].name);
        }
    }
}

/* A null pointer comes before all other faults. */
static void null_is_refused_whatever_else_is_wrong(void)
{
    for (int fault = 0; fault < FAULTS; fault++) {
        for (int n = 0; n < FUNCTIONS; n++) {
            for (int k = 0; functions[n].argument[k] != NONE; k++) {
                prepare(&DIRECT);
                faults[fault].put_in();
                pointer[functions[n].argument[k]] = NULL;
                check_failure(&functions[n], EDML_ERR_ARGUMENT, faults[fault].name);
            }
        }
    }
}

/* Two faults at once: a status of either, or of what both make. */
static void two_faults_leave_no_trace(void)
{
    for (int one = 0; one < FAULTS; one++) {
        for (int other = 0; other < FAULTS; other++) {
            for (int n = 0; n < FUNCTIONS; n++) {
                prepare(&FCONN);
                if (expected_status(one, &functions[n]) == EDML_OK) continue;
                if (expected_status(other, &functions[n]) == EDML_OK) continue;
                faults[one].put_in();
                if (other != one) faults[other].put_in();
                memcpy(&before, &memory, sizeof before);
                TEST_ASSERT_TRUE(functions[n].run() != EDML_OK);
                TEST_ASSERT_SAME_BYTES(before, memory);
            }
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(every_function_succeeds_with_these_arguments);
    RUN_TEST(null_is_refused);
    RUN_TEST(misaligned_work_memory_is_refused);
    RUN_TEST(one_byte_too_few_is_refused);
    RUN_TEST(just_enough_is_enough);
    RUN_TEST(models_say_how_much_they_need);
    RUN_TEST(a_model_that_reads_or_gives_something_else_is_refused);
    RUN_TEST(distances_without_what_scales_them_are_refused);
    RUN_TEST(a_model_that_this_arithmetic_cannot_run_is_refused);
    RUN_TEST(every_fault_has_its_status_and_leaves_no_trace);
    RUN_TEST(null_is_refused_whatever_else_is_wrong);
    RUN_TEST(two_faults_leave_no_trace);
    return UNITY_END();
}
