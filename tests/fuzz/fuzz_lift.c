/* Any bytes into edml_lift(), edml_track_lift() and edml_lift_q(), with every model and any upward direction: a
 * status that exists, and with it either a sound pose or none; in fixed point no overflow, by the integers that
 * watch themselves (tests/overflow).  What was lifted is placed before cameras of any kind, and lifted by them,
 * with the same demands.
 *
 * With libFuzzer (libfuzzer.sh) or, with its own main, on pseudo-random inputs: fuzz_lift [COUNT].
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "edmlift/video.h"
#include "overflow.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { JOINT_BYTES = sizeof(edml_keypoint), INPUT_BYTES = 1 + EDML_JOINTS * JOINT_BYTES };

static void require(int holds, const char *what)
{
    if (holds) return;
    fprintf(stderr, "fuzz_lift: %s\n", what);
    abort();
}

/* The first byte says how to read the others: as floats, whatever they be, or as 16-bit tenths of
 * pixels, which are people far more often. */
static void read_keypoints(edml_keypoint in[EDML_JOINTS], const uint8_t *data)
{
    memcpy(in, data + 1, INPUT_BYTES - 1);
    if (data[0] % 4 == 0) return;
    for (int j = 0; j < EDML_JOINTS; j++) {
        const uint8_t *bytes = data + 1 + j * JOINT_BYTES;
        in[j].x = (float)(bytes[0] | bytes[1] << 8) / 10;
        in[j].y = (float)(bytes[2] | bytes[3] << 8) / 10;
        in[j].c = bytes[4] < 16 ? 0 : bytes[4];
    }
}

static void check_pose(const edml_pose *pose)
{
    const float *number = &pose->joint[0].x;
    for (int n = 0; n < 3 * EDML_JOINTS; n++) require(isfinite(number[n]), "a joint is not finite");
    require(pose->misfit >= 0 && isfinite(pose->misfit), "a bad misfit");
    require(pose->seen < 1 << EDML_JOINTS, "a joint that does not exist was seen");
    for (int n = 0; n < EDML_BONES; n++) {
        const edml_point a = pose->joint[edml_bones[n].from], b = pose->joint[edml_bones[n].to];
        const float x = a.x - b.x, y = a.y - b.y, z = a.z - b.z;
        require(sqrtf(x * x + y * y + z * z) <= 4, "a bone is longer than 4 m");
    }
}

static void check_status(edml_status status)
{
    require(edml_status_name(status)[0] != '?', "an unknown status");
    require(status != EDML_ERR_ARGUMENT && status != EDML_ERR_MODEL, "a status without a cause");
}

static void check_placement_status(edml_status status)
{
    require(edml_status_name(status)[0] != '?', "an unknown status of a placement");
    require(status != EDML_ERR_ARGUMENT && status != EDML_ERR_MODEL,
            "a placement's status without a cause");
}

/* From a hundredth of a pixel to 10,000, by a byte. */
static float some_focal_length(uint8_t byte) { return 0.01F * powf(10, (float)byte / 42.5F); }

static void place_floats(const edml_pose *pose, const edml_keypoint in[EDML_JOINTS], const uint8_t *data,
                         edml_work *work)
{
    const float focal = some_focal_length(data[1]);
    const edml_camera camera = {focal, focal, in[data[2] % EDML_JOINTS].x, in[data[3] % EDML_JOINTS].y};
    edml_placement placement;
    const edml_status status = edml_place(&placement, pose, in, &camera, work, sizeof *work);
    check_placement_status(status);
    if (status != EDML_OK) return;
    for (int j = 0; j < EDML_JOINTS; j++) {
        const edml_point p = placement.joint[j];
        require(isfinite(p.x) && isfinite(p.y) && p.z > 0 && p.z < 110, "a joint is out of sight");
    }
    require(placement.reprojection >= 0 && isfinite(placement.reprojection), "a bad reprojection");
    require(placement.steps <= 53, "too many steps");
}

/* Any direction, also none at all; NULL in a quarter of the cases. */
static const edml_point *some_up(const uint8_t *data)
{
    static edml_point up;
    memcpy(&up, data + 1, sizeof up);
    if (data[0] % 4 != 0) {
        up.x = (float)data[4] - 128;
        up.y = (float)data[5] - 128;
        up.z = (float)data[6] - 128;
    }
    return data[7] % 4 == 0 ? NULL : &up;
}

static const edml_model *some_model(uint8_t byte)
{
    static const edml_model *const models[] = {
        &edml_distances_f32, &edml_direct_f32, &edml_fconn_f32, &edml_distances_w16,
        &edml_direct_w16,    &edml_fconn_w16,  &edml_direct_w8,
    };
    return models[byte % (sizeof models / sizeof *models)];
}

static void lift_by_camera(const edml_keypoint in[], const uint8_t *data, edml_work *work)
{
    const float focal = some_focal_length(data[1]);
    const edml_camera camera = {focal, focal, in[data[2] % EDML_JOINTS].x, in[data[3] % EDML_JOINTS].y};
    edml_pose pose;
    const edml_status status = edml_lift_with_camera(&pose, in, some_up(data), &camera, some_model(data[8]),
                                                     work, sizeof *work);
    check_status(status);
    if (status == EDML_OK) check_pose(&pose);
}

static void lift_floats(const uint8_t *data)
{
    edml_keypoint in[EDML_JOINTS];
    edml_pose pose, untouched;
    edml_work work;
    memset(&pose, 0xA5, sizeof pose);
    memcpy(&untouched, &pose, sizeof pose);
    memset(&work, data[0], sizeof work);
    read_keypoints(in, data);

    const edml_status status = edml_lift(&pose, in, some_up(data), some_model(data[8]), &work, sizeof work);
    check_status(status);
    if (status == EDML_OK) {
        check_pose(&pose);
        place_floats(&pose, in, data, &work);
        lift_by_camera(in, data, &work);
    } else {
        require(memcmp(&pose, &untouched, sizeof pose) == 0, "refused, but the pose was written");
    }
}

/* A short video.  The bytes of a frame are those of the one before, in half of the videos moved on by a
 * joint; time may stand still or run back. */
static void track_floats(const uint8_t *data)
{
    uint8_t moved[INPUT_BYTES], first[JOINT_BYTES];
    edml_keypoint in[EDML_JOINTS];
    edml_pose pose, before;
    edml_work work;
    edml_track track, untouched;
    uint32_t time = UINT32_MAX - data[1];
    memcpy(moved, data, sizeof moved);
    memset(&pose, 0xA5, sizeof pose);
    edml_track_start(&track);
    for (int n = 0; n < 2 + data[2] % 4; n++) {
        memcpy(&before, &pose, sizeof pose);
        memcpy(&untouched, &track, sizeof track);
        read_keypoints(in, moved);
        const edml_status status = edml_track_lift(&pose, &track, in, time, some_up(data),
                                                   some_model(data[8]), &work, sizeof work);
        require(edml_status_name(status)[0] != '?', "an unknown status of a frame");
        if (status == EDML_OK) {
            check_pose(&pose);
            require(track.jitter >= 0 && track.jitter <= 1, "a bad unsteadiness");
        } else {
            require(memcmp(&pose, &before, sizeof pose) == 0, "a frame refused, but the pose was written");
            require(memcmp(&track, &untouched, sizeof track) == 0, "a frame refused, but it left a trace");
        }
        time += (uint32_t)(data[3] + n) % 97 - 5;
        if (data[2] % 2 == 0) continue;
        memcpy(first, moved + 1, JOINT_BYTES);
        memmove(moved + 1, moved + 1 + JOINT_BYTES, INPUT_BYTES - 1 - JOINT_BYTES);
        memcpy(moved + INPUT_BYTES - JOINT_BYTES, first, JOINT_BYTES);
    }
}

/* As they are, or in 16-bit tenths of pixels, or such ones spread over the whole range. */
static void read_keypoints_q16(edml_keypoint_q in[EDML_JOINTS], const uint8_t *data)
{
    const int32_t unit = data[0] % 4 == 1 ? 65536 / 10 : 1 << data[0] / 4 % 15;
    for (int j = 0; j < EDML_JOINTS; j++) {
        const uint8_t *bytes = data + 1 + j * JOINT_BYTES;
        memcpy(&in[j].x, bytes, 4);
        memcpy(&in[j].y, bytes + 4, 4);
        memcpy(&in[j].c, bytes + 8, 2);
        if (data[0] % 4 == 0) continue;
        in[j].x = (int32_t)(bytes[0] | bytes[1] << 8) * unit;
        in[j].y = (int32_t)(bytes[2] | bytes[3] << 8) * unit;
        in[j].c = bytes[4] < 16 ? 0 : bytes[4];
        if (data[0] % 4 < 3) continue;
        in[j].x -= 32768 * unit;
        in[j].y -= 32768 * unit;
    }
}

static void check_pose_q(const edml_pose_q *pose)
{
    const int32_t *number = &pose->joint[0].x, limit = 16 << 16; /* metres */
    for (int n = 0; n < 3 * EDML_JOINTS; n++)
        require(number[n] > -limit && number[n] < limit, "a joint is not near the hips");
    require(pose->misfit >= 0 && pose->misfit < limit, "a bad misfit");
    require(pose->seen < 1 << EDML_JOINTS, "a joint that does not exist was seen");
}

static void place_integers(const edml_pose_q *pose, const edml_keypoint_q in[EDML_JOINTS],
                           const uint8_t *data, edml_work_q *work)
{
    const int32_t focal = (int32_t)(65536 * some_focal_length(data[1] % 250)); /* to 7,600 */
    const edml_camera_q camera = {focal, focal, in[data[2] % EDML_JOINTS].x, in[data[3] % EDML_JOINTS].y};
    edml_placement_q placement, watched;
    checked_tally taken;
    memset(&placement, 0xA5, sizeof placement);
    memset(&watched, 0xA5, sizeof watched);
    const edml_status status = edml_place_q(&placement, pose, in, &camera, work, sizeof *work);
    check_placement_status(status);
    require(checked_place(&watched, pose, in, &camera, &taken) == status,
            "another status of a watched placement");
    require(taken.overflows == 0, "a number of a placement overflows");
    require(memcmp(&placement, &watched, sizeof placement) == 0, "not the placement of watched numbers");
}

static const edml_point_q *some_up_q(const uint8_t *data)
{
    static edml_point_q up;
    memcpy(&up, data + 1, sizeof up);
    if (data[0] % 4 != 0) {
        up.x /= 1 << data[5] % 31;
        up.y /= 1 << data[6] % 31;
        up.z /= 1 << data[7] % 31;
    }
    return data[7] % 4 == 0 ? NULL : &up;
}

static const edml_model *some_model_q(uint8_t byte)
{
    static const edml_model *const models[] = {&edml_distances_w16, &edml_direct_w16, &edml_fconn_w16,
                                               &edml_distances_w8,  &edml_direct_w8,  &edml_fconn_w8};
    return models[byte % (sizeof models / sizeof *models)];
}

static void lift_integers_by_camera(const edml_keypoint_q in[], const uint8_t *data, edml_work_q *work)
{
    const edml_model *model = some_model_q(data[8]);
    const int32_t focal = (int32_t)(65536 * some_focal_length(data[1] % 250)); /* to 7,600 */
    const edml_camera_q camera = {focal, focal, in[data[2] % EDML_JOINTS].x, in[data[3] % EDML_JOINTS].y};
    edml_pose_q pose, watched;
    checked_tally taken;
    const edml_status status = edml_lift_with_camera_q(&pose, in, some_up_q(data), &camera, model, work,
                                                       sizeof *work);
    check_status(status);
    require(checked_lift_with_camera(&watched, in, some_up_q(data), &camera, model, &taken) == status,
            "another status of a watched lift by a camera");
    require(taken.overflows == 0, "a number of a lift by a camera overflows");
    if (status != EDML_OK) return;
    check_pose_q(&pose);
    require(memcmp(&pose, &watched, offsetof(edml_pose_q, seen)) == 0, "not the pose of watched numbers");
}

static void lift_integers(const uint8_t *data)
{
    const edml_model *model = some_model_q(data[8]);
    const edml_point_q *up = some_up_q(data);
    edml_keypoint_q in[EDML_JOINTS];
    edml_pose_q pose, watched;
    edml_work_q work;
    checked_tally taken;
    memset(&pose, 0xA5, sizeof pose);
    memset(&watched, 0xA5, sizeof watched);
    memset(&work, data[0], sizeof work);
    read_keypoints_q16(in, data);

    const edml_status status = edml_lift_q(&pose, in, up, model, &work, sizeof work);
    check_status(status);
    if (status == EDML_OK) check_pose_q(&pose);
    require(checked_lift(&watched, in, up, model, &taken) == status, "another status of watched numbers");
    require(taken.overflows == 0, "a number overflows");
    require(memcmp(&pose, &watched, sizeof pose) == 0, "not the pose of watched numbers");
    if (status != EDML_OK) return;
    place_integers(&pose, in, data, &work);
    lift_integers_by_camera(in, data, &work);
}

/* FConv takes hundreds of times as long: one input in 128. */
static void lift_by_convolutions(const uint8_t *data)
{
    static edml_fconv_work work;
    static edml_fconv_work_q work_q;
    edml_keypoint in[EDML_JOINTS];
    edml_keypoint_q in_q[EDML_JOINTS];
    edml_pose pose;
    edml_pose_q pose_q;
    memset(&work, data[0], sizeof work);
    memset(&work_q, data[0], sizeof work_q);
    read_keypoints(in, data);
    read_keypoints_q16(in_q, data);
    const edml_model *model = data[0] & 128 ? &edml_fconv_f32 : &edml_fconv_w8;
    const edml_status status = edml_lift(&pose, in, NULL, model, &work, sizeof work);
    check_status(status);
    if (status == EDML_OK) check_pose(&pose);
    const edml_status other = edml_lift_q(&pose_q, in_q, NULL, &edml_fconv_w8, &work_q, sizeof work_q);
    check_status(other);
    if (other == EDML_OK) check_pose_q(&pose_q);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size < INPUT_BYTES) return 0;
    lift_floats(data);
    track_floats(data);
    lift_integers(data);
    if (data[JOINT_BYTES - 1] % 128 == 0) lift_by_convolutions(data);
    return 0;
}

#ifndef EDML_LIBFUZZER
/* A person somewhere in the image; every coordinate is off by up to `spread` tenths. */
static void near_a_person(uint8_t data[INPUT_BYTES], uint32_t bits[], int n)
{
    static const int x[] = {0, 0, -36, -50, -44, 36, 54, 48, -26, -30, -32, 26, 30, 34};
    static const int y[] = {-160, -112, -100, -46, -16, -100, -48, -24, 0, 84, 168, 0, 86, 170};
    const int spread = 1 << n % 14;
    for (int j = 0; j < EDML_JOINTS; j++) {
        const int at_x = 20000 + 20 * x[j] + (int)(bits[2 * j] >> 16) % spread;
        const int at_y = 20000 + 20 * y[j] + (int)(bits[2 * j + 1] >> 16) % spread;
        uint8_t *bytes = data + 1 + j * JOINT_BYTES;
        bytes[0] = (uint8_t)at_x;
        bytes[1] = (uint8_t)(at_x >> 8);
        bytes[2] = (uint8_t)at_y;
        bytes[3] = (uint8_t)(at_y >> 8);
    }
}

int main(int argc, char **argv)
{
    const int count = argc > 1 ? atoi(argv[1]) : 20000;
    uint32_t state = 1;
    for (int n = 0; n < count; n++) {
        uint8_t data[INPUT_BYTES];
        uint32_t bits[INPUT_BYTES];
        for (int k = 0; k < INPUT_BYTES; k++) {
            state = state * 1664525U + 1013904223U;
            bits[k] = state;
            data[k] = (uint8_t)(state >> 24);
        }
        if (n % 2) near_a_person(data, bits, n);
        LLVMFuzzerTestOneInput(data, sizeof data);
    }
    printf("%d inputs\n", count);
    return 0;
}
#endif
