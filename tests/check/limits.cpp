/* SPDX-License-Identifier: MIT */
#include "real_check.h"

extern "C" {
#include "limits.h"
}

#include "vector.inc"
#include "pose.inc"
#include "torso.inc"

#include "limits.inc"

extern "C" int check_limits(const edml_pose_q *given, check_tally *taken)
{
    tally = check_tally();
    const int beyond = edml_limits_check(given);
    *taken = tally;
    return beyond;
}

extern "C" int check_mirror_by_limits(edml_pose_q *given, check_tally *taken)
{
    tally = check_tally();
    const int fewer = edml_mirror_by_limits_check(given);
    *taken = tally;
    return fewer;
}
