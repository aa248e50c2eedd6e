/* SPDX-License-Identifier: MIT */
#include "api_checked.h"

#include "optional/body.h"
#include "optional/measure_body.h"
#include "optional/quality.h"
#include "optional/stand.h"

extern "C" edml_status checked_fit_body(edml_pose_q *pose, const edml_body_q *body, checked_tally *taken)
{
    tally = checked_tally();
    const edml_status status = edml_fit_body_checked(pose, body);
    *taken = tally;
    return status;
}

extern "C" edml_status checked_quality(int32_t *quality, const edml_pose_q *pose, checked_tally *taken)
{
    tally = checked_tally();
    const edml_status status = edml_quality_checked(quality, pose);
    *taken = tally;
    return status;
}

extern "C" edml_status checked_stand(edml_point_q out[EDML_JOINTS], const edml_pose_q *pose,
                                     edml_point_q up, checked_tally *taken)
{
    tally = checked_tally();
    const edml_status status = edml_stand_checked(out, pose, up);
    *taken = tally;
    return status;
}

extern "C" edml_status checked_measure_body(edml_measured_body_q *measured, const edml_pose_q *pose,
                                            checked_tally *taken)
{
    tally = checked_tally();
    const edml_status status = edml_measure_body_checked(measured, pose);
    *taken = tally;
    return status;
}
