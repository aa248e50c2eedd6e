/* SPDX-License-Identifier: MIT */
#include "real_check.h"

#include "seen.inc"
#include "vector.inc"
#include "pose.inc"

#include "rotation.inc"

#include "camera.inc"

static void copy(edml_placement_q *out, const placement *placed)
{
    for (int j = 0; j < EDML_JOINTS; j++) out->joint[j] = placed->joint[j];
    for (int i = 0; i < 3; i++) out->rotation[i] = placed->rotation[i];
    out->translation = placed->translation;
    out->reprojection = placed->reprojection.value();
    out->steps = placed->steps;
}

extern "C" edml_status check_place(edml_placement_q *out, const edml_pose_q *pose,
                                   const edml_keypoint_q in[EDML_JOINTS],
                                   const edml_camera_q *seen_by, check_tally *taken)
{
    work_memory work;
    placement placed;
    const camera by = {seen_by->fx, seen_by->fy, seen_by->cx, seen_by->cy};
    tally = check_tally();
    const edml_status status = edml_place_check(&placed, pose, in, &by, &work);
    *taken = tally;
    if (status == EDML_OK) copy(out, &placed);
    return status;
}
