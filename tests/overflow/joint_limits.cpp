/* SPDX-License-Identifier: MIT */
#include "api_checked.h"

#include "optional/joint_limits.h"

extern "C" edml_status checked_joint_limits(int *violations, const edml_pose_q *pose, checked_tally *taken)
{
    tally = checked_tally();
    const edml_status status = edml_joint_limits_checked(violations, pose);
    *taken = tally;
    return status;
}

extern "C" edml_status checked_reflect_by_joint_limits(int *fewer, edml_pose_q *pose, checked_tally *taken)
{
    tally = checked_tally();
    const edml_status status = edml_reflect_by_joint_limits_checked(fewer, pose);
    *taken = tally;
    return status;
}
