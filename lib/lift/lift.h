/* The lift: strings the stages together.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_LIFT_H
#define EDML_LIFT_H

#include "../api/pose.h"
#include "../network/model.h"
#include "edm.h"
#include "fuse.h"
#include "mds.h"
#include "mirror.h"
#include "orient.h"
#include "refine.h"

edml_status edml_lift(edml_pose *pose, const edml_keypoint in[EDML_JOINTS], const edml_model *model,
                      void *memory, size_t work_bytes)
{
    if (pose == NULL || in == NULL || model == NULL || memory == NULL) return EDML_ERR_ARGUMENT;
    edml_status status = edml__check_model(model, WORK_BYTES(model), memory, work_bytes);
    if (status != EDML_OK) return status;
    edml_work *const work = memory;
    real *const edm = work->scratch.layer[0];
    const uint16_t seen = seen_joints(in);
    status = image_distances(edm, in, seen, model->fewest_joints, PARAM(model->max_aspect),
                             model->imputation, edm);
    if (status != EDML_OK) return status;

    RUN_NETWORK(work->distance, edm, model, work);
    edml_mds(work->x, work->distance, work);
    edml_refine(work->x, work->distance, (edml_objective)model->objective, model->refine_steps, work);
    const real residual = SQRT(edml_stress(work->x, work->distance, EDML_STRESS_RAW));
    const real margin = edml_mirror(work->x, model);
    status = orient_points(work->x, in, seen);
    if (status != EDML_OK) return status;
    edml_fuse(work->x, in, seen, model);
    for (int j = 0; j < EDML_JOINTS; j++) pose->joint[j] = api_point(work->x[j]);
    pose->residual = TO_API(residual);
    pose->mirror_margin = TO_API(margin);
    pose->seen = seen;
    return EDML_OK;
}

#endif
