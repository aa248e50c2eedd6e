/* SPDX-License-Identifier: MIT */
#include "real_check.h"

check_tally tally;

#include "seen.inc"
#include "vector.inc"

#include "complete.inc"
#include "edm.inc"
#include "jacobi.inc"
#include "mds.inc"
#include "refine.inc"
#include "torso.inc"
#include "mirror.inc"
#include "orient.inc"
#include "blend.inc"

/* The network is whole numbers all the same; the exporter proves its ranges. */
static void NAME(edml_net)(real distance[EDML_PAIRS], const real edm[EDML_PAIRS],
                           const edml_model *model, work_memory *)
{
    int32_t values[EDML_PAIRS], layer[2][EDML_MAX_UNITS];
    for (int k = 0; k < EDML_PAIRS; k++) values[k] = edm[k].value();
    model->predict_q(values, values, model, layer);
    for (int k = 0; k < EDML_PAIRS; k++) distance[k] = values[k];
}

#include "lift.inc"

static void copy(int32_t out[EDML_JOINTS][3], const point x[EDML_JOINTS])
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        out[j][0] = x[j].x.value();
        out[j][1] = x[j].y.value();
        out[j][2] = x[j].z.value();
    }
}

extern "C" edml_status check_lift(edml_pose_q *out, const edml_keypoint_q in[EDML_JOINTS],
                                  const edml_model *model, check_tally *taken)
{
    work_memory work;
    tally = check_tally();
    const edml_status status = edml_lift_check(out, in, model, &work);
    *taken = tally;
    return status;
}

extern "C" void check_points(int32_t out[EDML_JOINTS][3], const int32_t distance[EDML_PAIRS],
                             const edml_keypoint_q in[EDML_JOINTS], const edml_model *model,
                             check_tally *taken)
{
    work_memory work;
    point x[EDML_JOINTS];
    tally = check_tally();
    for (int k = 0; k < EDML_PAIRS; k++) work.distance[k] = distance[k];
    edml_mds_check(x, work.distance, &work);
    edml_stress_check(x, work.distance, EDML_STRESS_RAW);
    edml_mirror_check(x, model);
    edml_orient_check(x, in, seen_joints(in));
    edml_blend_check(x, in, seen_joints(in), model);
    copy(out, x);
    *taken = tally;
}

extern "C" int check_refine(int32_t out[EDML_JOINTS][3], const int32_t distance[EDML_PAIRS],
                            edml_objective objective, int steps, check_tally *taken)
{
    work_memory work;
    point x[EDML_JOINTS];
    tally = check_tally();
    for (int k = 0; k < EDML_PAIRS; k++) work.distance[k] = distance[k];
    edml_mds_check(x, work.distance, &work);
    const int steps_taken = edml_refine_check(x, work.distance, objective, steps, &work);
    copy(out, x);
    *taken = tally;
    return steps_taken;
}
