/* The lift: strings the stages together.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_LIFT_H
#define EDML_LIFT_H

#include "../api/pose.h"
#include "../geometry/unit_vector.h"
#include "../network/model.h"
#include "body_frame.h"
#include "edm.h"
#include "fuse.h"
#include "predict.h"
#include "scale.h"

/* The image in the body's frame, and what the network says of it.  Out of line, as its locals are not needed
 * where the stack is deepest. */
static EDML_NOINLINE edml_status ask_network(edml_work *work, const edml_keypoint in[EDML_JOINTS],
                                             const edml_point *up, const edml_model *model)
{
    point direction;
    edml_status status = up == NULL ? EDML_OK : unit_vector(&direction, *up);
    if (status != EDML_OK) return status;
    status = to_body_frame(&work->image, in, model->fewest_joints, model->imputation, work->of.network.io.values);
    if (status == EDML_OK)
        predict(&work->of.points.prediction, &work->image, up == NULL ? NULL : &direction, model, work);
    return status;
}

/* Points in the body's frame, of what the network says. */
static edml_status find_points(edml_work *work, const edml_model *model)
{
    if (SCALE(model) != NULL) return SCALE(model)(work, model);
    if (model->gives & EDML_GIVES_DISTANCES) return EDML_ERR_MODEL;
    memcpy(work->x, work->of.points.prediction.x, sizeof work->x);
    return EDML_OK;
}

/* From the body's frame to the camera's axes: two sums, as in turn_down(). */
static void turn_to_camera(point x[EDML_JOINTS], edml_image_point down)
{
    const real minus_u = -down.u;
    for (int j = 0; j < EDML_JOINTS; j++) {
        const point p = x[j];
        x[j].x = MUL(down.v, p.x) + MUL(down.u, p.y);
        x[j].y = MUL(down.v, p.y) + MUL(minus_u, p.x);
        /* 31.75 at most from a mean within 6 on each axis */
        ASSUME(WITHIN(x[j].x, REAL(41.0)) && WITHIN(x[j].y, REAL(41.0)));
    }
    move_origin_to_mid_hip(x);
}

edml_status edml_lift(edml_pose *pose, const edml_keypoint in[EDML_JOINTS], const edml_point *up,
                      const edml_model *model, void *memory, size_t work_bytes)
{
    if (pose == NULL || in == NULL || model == NULL || memory == NULL) return EDML_ERR_ARGUMENT;
    edml_status status = edml__check_model(model, WORK_BYTES(model), memory, work_bytes);
    if (status != EDML_OK) return status;
    edml_work *const work = (edml_work *)memory; /* tests/overflow compiles this as C++ */
    status = ask_network(work, in, up, model);
    if (status != EDML_OK) return status;
    status = find_points(work, model);
    if (status != EDML_OK) return status;
    const real misfit = edml_fuse(work->x, &work->image, work->of.points.prediction.share, model);
    turn_to_camera(work->x, work->image.down);
    for (int j = 0; j < EDML_JOINTS; j++) {
        /* no two are farther apart than sqrt(2 * 14 * 72) = 45 m across and along */
        ASSUME(WITHIN(work->x[j].x, REAL(45.0)) && WITHIN(work->x[j].y, REAL(45.0)));
        pose->joint[j] = api_point(work->x[j]);
    }
    pose->misfit = TO_API(misfit);
    pose->seen = work->image.seen;
    return EDML_OK;
}

#endif
