/* What is known of a video beside its tracks: each person's bones and path, and the camera.
 *
 * SPDX-License-Identifier: MIT
 */
#include "lift_stdin.h"

void start_person(person_track *by)
{
    edml_measure_start(&by->bones);
    edml_path_start(&by->path);
}

void hold_bones(edml_pose *pose, person_track *by, const options *set)
{
    if (by->bones.poses < set->hold_bones) /* a pose of nobody's size is not measured */
        (void)edml_measure_body(&by->bones, pose);
    if (by->bones.poses > 0)
        (void)edml_fit_body(pose, &by->bones.body); /* if it cannot be, the pose is as lifted */
}

/* The camera of the video: that of the options, or the one that its first pose was seen by. */
static edml_status find_camera(edml_camera *camera, const edml_pose *pose,
                               const edml_keypoint joints[EDML_JOINTS], const options *set, void *work,
                               size_t work_bytes)
{
    edml_focal focal;
    if (camera->fx > 0) return EDML_OK;
    *camera = set->camera;
    if (!set->sweep) return EDML_OK;
    edml_status status = edml_focal_start(&focal, set->width, set->height);
    if (status == EDML_OK) status = edml_focal_add(&focal, pose, joints, work, work_bytes);
    return status == EDML_OK ? edml_focal_camera(camera, &focal) : status;
}

void place_frame(answer *out, person_track *by, const edml_keypoint joints[EDML_JOINTS], uint32_t time_ms,
                 const options *set, void *work, size_t work_bytes)
{
    static edml_camera camera; /* fx 0: not known yet */
    edml_placement placement;
    edml_status status = find_camera(&camera, &out->pose, joints, set, work, work_bytes);
    if (status == EDML_OK) status = edml_place(&placement, &out->pose, joints, &camera, work, work_bytes);
    if (status == EDML_OK) status = edml_path_follow(&by->path, &placement, time_ms);
    take_placement(out, status, &placement, camera.fx);
}
