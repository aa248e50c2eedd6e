/* SPDX-License-Identifier: MIT */
#include "api_checked.h"

#include "optional/video.h"

static edml_track_checked followed;

extern "C" void checked_track_start(const edml_track_q *set)
{
    edml_track_start_checked(&followed);
    followed.smooth_image = set->smooth_image;
    followed.smooth_space = set->smooth_space;
    followed.noise_full = set->noise_full;
}

extern "C" edml_status checked_track_lift(edml_pose_q *out, int32_t *distance,
                                          const edml_keypoint_q in[EDML_JOINTS], uint32_t time_ms,
                                          const edml_model *model, checked_tally *taken)
{
    edml_work_checked work;
    const checked_keypoints seen(in, EDML_JOINTS);
    tally = checked_tally();
    *distance = edml_track_distance_checked(&followed, seen.joint, time_ms);
    const edml_status status = edml_track_lift_checked(out, &followed, seen.joint, time_ms, nullptr, model,
                                                       &work, sizeof work);
    *taken = tally;
    return status;
}
