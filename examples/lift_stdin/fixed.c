/* The lift and what follows it in fixed point: everything between the numbers read and the numbers
 * printed is done in integers, as on a core without an FPU.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <string.h>

#include "lift_stdin.h"

/* Saturates, as hardware does: NaN and infinity become what edml_lift_q() calls not finite. */
static int32_t saturate(double value, double low, double high)
{
    if (!(value > low)) return (int32_t)low;
    if (value >= high) return (int32_t)high;
    return (int32_t)(value < 0 ? value - 0.5 : value + 0.5);
}

static edml_keypoint_q to_q16(edml_keypoint in)
{
    edml_keypoint_q out;
    out.x = saturate(65536.0 * (double)in.x, INT32_MIN, INT32_MAX);
    out.y = saturate(65536.0 * (double)in.y, INT32_MIN, INT32_MAX);
    out.c = in.c > 0 ? (int16_t)saturate(32767.0 * (double)in.c, 1, INT16_MAX) : 0;
    if (!isfinite(in.c)) { /* nothing in this joint is known */
        out.x = INT32_MIN;
        out.c = 1;
    }
    return out;
}

static float to_float(int32_t value) { return (float)(value / 65536.0); }

static edml_point point_of(edml_point_q p)
{
    const edml_point q = {to_float(p.x), to_float(p.y), to_float(p.z)};
    return q;
}

static int32_t to_fixed(float value) { return saturate(65536.0 * (double)value, INT32_MIN, INT32_MAX); }

static edml_camera_q camera_of(const options *set)
{
    const edml_camera_q camera = {to_fixed(set->camera.fx), to_fixed(set->camera.fy),
                                  to_fixed(set->camera.cx), to_fixed(set->camera.cy)};
    return camera;
}

/* As those of video.c. */
static void hold_bones_q(edml_pose_q *pose, followed_q *by, const options *set)
{
    if (by->bones.poses < set->hold_bones) (void)edml_measure_body_q(&by->bones, pose);
    if (by->bones.poses > 0) (void)edml_fit_body_q(pose, &by->bones.body);
}

static edml_status find_camera_q(edml_camera_q *camera, const edml_pose_q *pose, const edml_keypoint_q in[],
                                 const options *set, void *work, size_t work_bytes)
{
    edml_focal_q focal;
    if (camera->fx > 0) return EDML_OK;
    *camera = camera_of(set);
    if (!set->sweep) return EDML_OK;
    edml_status status = edml_focal_start_q(&focal, to_fixed(set->width), to_fixed(set->height));
    if (status == EDML_OK) status = edml_focal_add_q(&focal, pose, in, work, work_bytes);
    return status == EDML_OK ? edml_focal_camera_q(camera, &focal) : status;
}

static edml_status place_frame_q(edml_placement_q *placed, edml_camera_q *found, followed_q *by,
                                 const edml_pose_q *pose, const edml_keypoint_q in[], double ms,
                                 const options *set, void *work, size_t work_bytes)
{
    static edml_camera_q camera; /* fx 0: not known yet */
    edml_status status = find_camera_q(&camera, pose, in, set, work, work_bytes);
    if (status == EDML_OK) status = edml_place_q(placed, pose, in, &camera, work, work_bytes);
    if (status == EDML_OK) status = edml_path_follow_q(&by->path, placed, clock_of(ms));
    *found = camera;
    return status;
}

static edml_status place_still(edml_placement_q *placed, edml_camera_q *camera, const edml_pose_q *pose,
                               const edml_keypoint_q in[], const options *set, void *work,
                               size_t work_bytes)
{
    *camera = camera_of(set);
    return set->sweep ? edml_place_sweep_q(placed, camera, pose, in, to_fixed(set->width),
                                           to_fixed(set->height), work, work_bytes)
                      : edml_place_q(placed, pose, in, camera, work, work_bytes);
}

/* by  NULL: not in a video */
static void place_fixed(answer *out, person_track *by, const edml_pose_q *pose, const edml_keypoint_q in[],
                        double ms, const options *set, void *work, size_t work_bytes)
{
    edml_camera_q camera;
    edml_placement_q placed;
    edml_placement placement;
    const edml_status status = by != NULL ? place_frame_q(&placed, &camera, &by->fixed, pose, in, ms, set,
                                                          work, work_bytes)
                                          : place_still(&placed, &camera, pose, in, set, work, work_bytes);
    if (status == EDML_OK) {
        for (int j = 0; j < EDML_JOINTS; j++) placement.joint[j] = point_of(placed.joint[j]);
        placement.translation = point_of(placed.translation);
        placement.reprojection = to_float(placed.reprojection);
    }
    take_placement(out, status, &placement, to_float(camera.fx));
}

static edml_status lift_still(edml_pose_q *pose, const edml_keypoint_q in[EDML_JOINTS], const options *set,
                              void *work, size_t work_bytes)
{
    const edml_point_q given = {to_fixed(set->up.x), to_fixed(set->up.y), to_fixed(set->up.z)};
    const edml_point_q *up = knows_up(set) ? &given : NULL;
    if (set->camera.fx > 0) {
        const edml_camera_q camera = camera_of(set);
        const edml_status status = edml_lift_with_camera_q(pose, in, up, &camera, set->model, work,
                                                           work_bytes);
        if (status != EDML_ERR_CAMERA) return status;
    }
    return edml_lift_q(pose, in, up, set->model, work, work_bytes);
}

/* The joints that keypoints show. */
static void adapt_fixed(edml_keypoint_q joints[EDML_JOINTS], const edml_keypoint_q in[], const options *set)
{
    edml_keypoint_q seen[EDML_JOINTS];
    if (set->format != NULL)
        edml_adapt_q(seen, in, set->format);
    else
        memcpy(seen, in, sizeof seen);
    for (int j = 0; j < EDML_JOINTS; j++) joints[j] = seen[set->mirrored ? edml_mirror_joint[j] : j];
}

static edml_smoothing_q smoothing_of(edml_smoothing by)
{
    const edml_smoothing_q fixed = {to_fixed(by.cutoff), to_fixed(by.slope)};
    return fixed;
}

void start_fixed_track(edml_track_q *track, const options *set)
{
    edml_track_start_q(track);
    if (set->smooth_image.cutoff > 0) track->smooth_image = smoothing_of(set->smooth_image);
    if (set->smooth_space.cutoff > 0) track->smooth_space = smoothing_of(set->smooth_space);
    if (set->noise_full >= 0) track->noise_full = to_fixed(set->noise_full);
}

float distance_fixed(const edml_track_q *track, const edml_keypoint joints[EDML_JOINTS], double ms)
{
    edml_keypoint_q seen[EDML_JOINTS];
    for (int j = 0; j < EDML_JOINTS; j++) seen[j] = to_q16(joints[j]);
    const int32_t distance = edml_track_distance_q(track, seen, clock_of(ms));
    return distance < INT32_MAX ? to_float(distance) : HUGE_VALF;
}

static edml_status lift_frame(edml_pose_q *pose, edml_keypoint_q in[EDML_JOINTS], double ms, followed_q *by,
                              const options *set, void *work, size_t work_bytes)
{
    const edml_point_q up = {to_fixed(set->up.x), to_fixed(set->up.y), to_fixed(set->up.z)};
    const edml_status status = edml_track_lift_q(pose, &by->track, in, clock_of(ms),
                                                 knows_up(set) ? &up : NULL, set->model, work, work_bytes);
    if (status != EDML_OK) return status;
    edml_track_swap_sides_q(in, &by->track);
    if (by->track.elapsed == 0 && by->track.aside == 0) {
        edml_measure_start_q(&by->bones);
        edml_path_start_q(&by->path);
    }
    return EDML_OK;
}

static void put_sides_right(edml_keypoint joints[EDML_JOINTS], const edml_track_q *track)
{
    edml_track swaps;
    swaps.swapped = track->swapped;
    edml_track_swap_sides(joints, &swaps);
}

edml_status lift_fixed(answer *out, edml_keypoint joints[EDML_JOINTS], const edml_keypoint in[], double ms,
                       person_track *by, const options *set)
{
    edml_keypoint_q keypoints[KEYPOINTS_MAX], seen[EDML_JOINTS];
    edml_pose_q lifted;
    static edml_fconv_work_q work;
    for (int n = 0; n < keypoints_of(set); n++) keypoints[n] = to_q16(in[n]);
    adapt_fixed(seen, keypoints, set);
    edml_status status = by != NULL ? lift_frame(&lifted, seen, ms, &by->fixed, set, &work, sizeof work)
                                    : lift_still(&lifted, seen, set, &work, sizeof work);
    if (by != NULL) feed_track(by, ms, status == EDML_OK);
    out->person = by != NULL ? by->number : -1;
    if (status != EDML_OK) return status;
    if (by != NULL) put_sides_right(joints, &by->fixed.track);
    int32_t quality = 0; /* also of a pose that has none */
    (void)edml_quality_q(&quality, &lifted);
    out->quality = to_float(quality);
    const edml_body_q body = {to_fixed(set->body.height), {0}};
    if (set->body.height > 0) status = edml_fit_body_q(&lifted, &body);
    if (status != EDML_OK) return status;
    if (by != NULL && by->fixed.track.aside > 0) by = NULL; /* somebody else, for a moment */
    if (by != NULL) hold_bones_q(&lifted, &by->fixed, set);
    for (int j = 0; j < EDML_JOINTS; j++) out->pose.joint[j] = point_of(lifted.joint[j]);
    out->pose.misfit = to_float(lifted.misfit);
    out->pose.seen = lifted.seen;
    if (places(set)) place_fixed(out, by, &lifted, seen, ms, set, &work, sizeof work);
    return EDML_OK;
}
