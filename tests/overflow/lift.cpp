/* SPDX-License-Identifier: MIT */
#include "api_checked.h"

#include "lift/lift.h"

checked_tally tally;
edml_status (*const checked_orientation)(edml_work_checked *, const edml_model *) = edml__orient_alone;

static void copy(int32_t out[EDML_JOINTS][3], const point x[EDML_JOINTS])
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        out[j][0] = x[j].x.value();
        out[j][1] = x[j].y.value();
        out[j][2] = x[j].z.value();
    }
}

extern "C" edml_status checked_lift(edml_pose_q *out, const edml_keypoint_q in[EDML_JOINTS],
                                    const edml_point_q *up, const edml_model *model,
                                    checked_tally *taken)
{
    edml_work_checked work;
    const checked_keypoints seen(in, EDML_JOINTS);
    tally = checked_tally();
    const edml_status status = edml_lift_checked(out, seen.joint, up, model, &work, sizeof work);
    *taken = tally;
    return status;
}

extern "C" int checked_refine(int32_t out[EDML_JOINTS][3], const int32_t distance[EDML_PAIRS],
                              edml_objective objective, int steps, checked_tally *taken)
{
    edml_work_checked work;
    real between[EDML_PAIRS];
    point x[EDML_JOINTS];
    tally = checked_tally();
    for (int k = 0; k < EDML_PAIRS; k++) between[k] = distance[k];
    edml_mds_checked(x, between, &work);
    edml_stress_checked(x, between, objective);
    const int steps_taken = edml_refine_checked(x, between, objective, steps, &work);
    copy(out, x);
    *taken = tally;
    return steps_taken;
}
