/* SPDX-License-Identifier: MIT */
#include "api_checked.h"

#include "optional/camera/focal.h"
#include "optional/camera/lift_with_camera.h"
#include "optional/camera/path.h"
#include "optional/camera/pnp.h"

extern "C" edml_status checked_lift_with_camera(edml_pose_q *out, const edml_keypoint_q in[EDML_JOINTS],
                                                const edml_point_q *up, const edml_camera_q *camera,
                                                const edml_model *model, checked_tally *taken)
{
    edml_work_checked work;
    const checked_keypoints seen(in, EDML_JOINTS);
    const edml_camera_checked by = {camera->fx, camera->fy, camera->cx, camera->cy};
    tally = checked_tally();
    const edml_status status = edml_lift_with_camera_checked(out, seen.joint, up, &by, model, &work,
                                                             sizeof work);
    *taken = tally;
    return status;
}

static void copy(edml_placement_q *out, const edml_placement_checked *placed)
{
    for (int j = 0; j < EDML_JOINTS; j++) out->joint[j] = placed->joint[j];
    for (int i = 0; i < 3; i++) out->rotation[i] = placed->rotation[i];
    out->translation = placed->translation;
    out->reprojection = placed->reprojection.value();
    out->steps = placed->steps;
}

extern "C" edml_status checked_place(edml_placement_q *out, const edml_pose_q *pose,
                                     const edml_keypoint_q in[EDML_JOINTS], const edml_camera_q *camera,
                                     checked_tally *taken)
{
    edml_work_checked work;
    edml_placement_checked placed;
    const checked_keypoints seen(in, EDML_JOINTS);
    const edml_camera_checked by = {camera->fx, camera->fy, camera->cx, camera->cy};
    tally = checked_tally();
    const edml_status status = edml_place_checked(&placed, pose, seen.joint, &by, &work, sizeof work);
    *taken = tally;
    if (status == EDML_OK) copy(out, &placed);
    return status;
}

extern "C" edml_status checked_place_sweep(edml_placement_q *out, edml_camera_q *camera,
                                           const edml_pose_q *pose, const edml_keypoint_q in[EDML_JOINTS],
                                           int32_t width, int32_t height, checked_tally *taken)
{
    edml_work_checked work;
    edml_placement_checked placed;
    edml_camera_checked by;
    const checked_keypoints seen(in, EDML_JOINTS);
    tally = checked_tally();
    const edml_status status = edml_place_sweep_checked(&placed, &by, pose, seen.joint, width, height,
                                                        &work, sizeof work);
    *taken = tally;
    if (status != EDML_OK) return status;
    copy(out, &placed);
    camera->fx = by.fx.value();
    camera->fy = by.fy.value();
    camera->cx = by.cx.value();
    camera->cy = by.cy.value();
    return status;
}

extern "C" edml_status checked_path_follow(edml_path_q *path, edml_placement_q *placement, uint32_t time_ms,
                                           checked_tally *taken)
{
    edml_placement_checked placed;
    for (int j = 0; j < EDML_JOINTS; j++) placed.joint[j] = placement->joint[j];
    for (int i = 0; i < 3; i++) placed.rotation[i] = placement->rotation[i];
    placed.translation = placement->translation;
    placed.reprojection = placement->reprojection;
    placed.steps = placement->steps;
    tally = checked_tally();
    const edml_status status = edml_path_follow_checked(path, &placed, time_ms);
    *taken = tally;
    copy(placement, &placed);
    return status;
}

extern "C" edml_status checked_focal_add(edml_focal_q *focal, edml_camera_q *camera,
                                         const edml_pose_q *pose, const edml_keypoint_q in[EDML_JOINTS],
                                         checked_tally *taken)
{
    edml_work_checked work;
    edml_focal_checked search;
    edml_camera_checked by;
    const checked_keypoints seen(in, EDML_JOINTS);
    tally = checked_tally();
    edml_status status = edml_focal_start_checked(&search, focal->width, focal->height);
    for (int n = 0; n < EDML_FOCAL_LENGTHS; n++) search.misfit[n] = focal->misfit[n];
    search.poses = focal->poses;
    if (status == EDML_OK) status = edml_focal_add_checked(&search, pose, seen.joint, &work, sizeof work);
    if (status == EDML_OK) status = edml_focal_camera_checked(&by, &search);
    *taken = tally;
    if (status != EDML_OK) return status;
    for (int n = 0; n < EDML_FOCAL_LENGTHS; n++) focal->misfit[n] = search.misfit[n];
    focal->poses = search.poses;
    camera->fx = by.fx.value();
    camera->fy = by.fy.value();
    camera->cx = by.cx.value();
    camera->cy = by.cy.value();
    return status;
}
