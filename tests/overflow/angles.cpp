/* SPDX-License-Identifier: MIT */
#include "api_checked.h"

#include "optional/angles.h"

extern "C" edml_status checked_angles(int32_t degrees[EDML_ANGLES], const edml_pose_q *pose,
                                      const edml_point_q *up, checked_tally *taken)
{
    tally = checked_tally();
    const edml_status status = edml_angles_checked(degrees, pose, up);
    *taken = tally;
    return status;
}
