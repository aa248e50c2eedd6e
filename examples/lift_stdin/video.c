/* What a video knows beside its tracks: each person's bones and path, and its camera.
 *
 * SPDX-License-Identifier: MIT
 */
#include "lift_stdin.h"

void start_person(followed_person *person)
{
    edml_measure_start(&person->bones);
    edml_path_start(&person->path);
}

void hold_bones(edml_pose *pose, followed_person *person, const options *set)
{
    if (person->bones.poses < set->hold_bones) /* a pose of nobody's size is not measured */
        (void)edml_measure_body(&person->bones, pose);
    if (person->bones.poses > 0)
        (void)edml_fit_body(pose, &person->bones.body); /* if it cannot be, the pose is as lifted */
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

void place_frame(answer *out, followed_person *person, edml_camera *camera,
                 const edml_keypoint joints[EDML_JOINTS], uint32_t time_ms, const options *set, void *work,
                 size_t work_bytes)
{
    edml_placement placement;
    edml_status status = find_camera(camera, &out->pose, joints, set, work, work_bytes);
    if (status == EDML_OK) status = edml_place(&placement, &out->pose, joints, camera, work, work_bytes);
    if (status == EDML_OK) status = edml_path_follow(&person->path, &placement, time_ms);
    take_placement(out, status, &placement, camera->fx);
}
