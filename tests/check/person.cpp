/* SPDX-License-Identifier: MIT */
#include "real_check.h"

#include "seen.inc"
#include "vector.inc"
#include "pose.inc"

#include "person.inc"
#include "quality.inc"
#include "floor.inc"

extern "C" edml_status check_fit_person(edml_pose_q *fitted, const edml_body_q *owner,
                                        check_tally *taken)
{
    tally = check_tally();
    const edml_status status = edml_fit_person_check(fitted, owner);
    *taken = tally;
    return status;
}

extern "C" int32_t check_quality(const edml_pose_q *lifted,
                                 const edml_keypoint_q in[EDML_JOINTS], check_tally *taken)
{
    tally = check_tally();
    const int32_t quality = edml_quality_check(lifted, in);
    *taken = tally;
    return quality;
}

extern "C" edml_status check_floor(edml_point_q out[EDML_JOINTS], const edml_pose_q *given,
                                   edml_point_q up, check_tally *taken)
{
    tally = check_tally();
    const edml_status status = edml_floor_check(out, given, up);
    *taken = tally;
    return status;
}
