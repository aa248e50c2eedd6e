/* SPDX-License-Identifier: MIT */
#include "api_checked.h"

#include "optional/camera/lift_with_camera.h"
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
