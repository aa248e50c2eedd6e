/* SPDX-License-Identifier: MIT */
#include "api_checked.h"

#include "lift/lift.h"

checked_tally tally;

checked_scale *checked_scaling(const edml_model *model)
{
    if (model->scale_q == NULL) return NULL;
    return model->gives & EDML_GIVES_POINTS ? edml__scale_and_align : edml__scale_and_orient;
}

static void copy(int32_t *out, const point x[EDML_JOINTS])
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        *out++ = x[j].x.value();
        *out++ = x[j].y.value();
        *out++ = x[j].z.value();
    }
}

/* Points and images of these numbers, and back. */
static void take(point x[EDML_JOINTS], const edml_point_q24 from[EDML_JOINTS])
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        x[j].x = from[j].x;
        x[j].y = from[j].y;
        x[j].z = from[j].z;
    }
}

static edml_image_checked image_of(const edml_image_q *from)
{
    edml_image_checked image;
    for (int j = 0; j < EDML_JOINTS; j++) {
        image.at[j].u = from->at[j].u;
        image.at[j].v = from->at[j].v;
    }
    image.down.u = from->down.u;
    image.down.v = from->down.v;
    image.seen = from->seen;
    return image;
}

extern "C" edml_status checked_body_frame(edml_image_q *out, const edml_keypoint_q in[EDML_JOINTS],
                                          int fewest_joints, const edml_imputation *imputation,
                                          checked_tally *taken)
{
    edml_image_checked image;
    const checked_keypoints seen(in, EDML_JOINTS);
    tally = checked_tally();
    const edml_status status = edml_body_frame_checked(&image, seen.joint, fewest_joints, imputation);
    *taken = tally;
    if (status != EDML_OK) return status;
    for (int j = 0; j < EDML_JOINTS; j++) {
        out->at[j].u = image.at[j].u.value();
        out->at[j].v = image.at[j].v.value();
    }
    out->down.u = image.down.u.value();
    out->down.v = image.down.v.value();
    out->seen = image.seen;
    return status;
}

extern "C" edml_status checked_predict(edml_prediction_q *out, const edml_image_q *from,
                                       const edml_point_q24 *up, const edml_model *model,
                                       checked_tally *taken)
{
    edml_work_checked work;
    edml_prediction_checked said;
    const edml_image_checked image = image_of(from);
    point direction;
    if (up != nullptr) {
        direction.x = up->x;
        direction.y = up->y;
        direction.z = up->z;
    }
    tally = checked_tally();
    const edml_status status = edml_predict_checked(&said, &image, up == nullptr ? nullptr : &direction,
                                                    model, &work, sizeof work);
    *taken = tally;
    for (int k = 0; k < EDML_PAIRS && model->gives & EDML_GIVES_DISTANCES; k++)
        out->distance[k] = said.distance[k].value();
    for (int j = 0; j < EDML_JOINTS; j++) out->share[j] = said.share[j].value();
    if (model->gives & EDML_GIVES_POINTS) copy(&out->x[0].x, said.x);
    return status;
}

extern "C" void checked_jacobi(edml_eigen_q *out, const edml_matrix_q *from, checked_tally *taken)
{
    edml_matrix_checked a;
    edml_eigen_checked eigen;
    for (int i = 0; i < EDML_JOINTS; i++)
        for (int j = 0; j < EDML_JOINTS; j++) a.at[i][j] = from->at[i][j];
    tally = checked_tally();
    edml_jacobi_checked(&eigen, &a);
    *taken = tally;
    for (int i = 0; i < EDML_JOINTS; i++) {
        out->value[i] = eigen.value[i].value();
        for (int j = 0; j < EDML_JOINTS; j++) out->vector[i][j] = eigen.vector[i][j].value();
    }
}

extern "C" void checked_align(edml_point_q24 out[EDML_JOINTS], const edml_point_q24 onto[EDML_JOINTS],
                              const edml_model *model, checked_tally *taken)
{
    point x[EDML_JOINTS], others[EDML_JOINTS];
    take(x, out);
    take(others, onto);
    tally = checked_tally();
    edml_align_checked(x, others, model);
    *taken = tally;
    copy(&out[0].x, x);
}

extern "C" edml_status checked_orient(edml_point_q24 out[EDML_JOINTS], const edml_image_q *from,
                                      checked_tally *taken)
{
    const edml_image_checked image = image_of(from);
    point x[EDML_JOINTS];
    take(x, out);
    tally = checked_tally();
    const edml_status status = edml_orient_checked(x, &image);
    *taken = tally;
    if (status == EDML_OK) copy(&out[0].x, x);
    return status;
}

extern "C" edml_status checked_lift(edml_pose_q *out, const edml_keypoint_q in[EDML_JOINTS],
                                    const edml_point_q *up, const edml_model *model, checked_tally *taken)
{
    edml_work_checked work;
    const checked_keypoints seen(in, EDML_JOINTS);
    tally = checked_tally();
    const edml_status status = edml_lift_checked(out, seen.joint, up, model, &work, sizeof work);
    *taken = tally;
    return status;
}

/* The objective before it as well. */
static int refine(point x[EDML_JOINTS], const real distance[EDML_PAIRS], edml_objective objective, int steps,
                  edml_work_checked *work)
{
    edml_stress_checked(x, distance, objective);
    return edml_refine_checked(x, distance, objective, steps, work);
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
    const int steps_taken = refine(x, between, objective, steps, &work);
    copy(&out[0][0], x);
    *taken = tally;
    return steps_taken;
}

extern "C" int checked_refine_points(edml_point_q24 out[EDML_JOINTS], const int32_t distance[EDML_PAIRS],
                                     edml_objective objective, int steps, checked_tally *taken)
{
    edml_work_checked work;
    real between[EDML_PAIRS];
    point x[EDML_JOINTS];
    take(x, out);
    tally = checked_tally();
    for (int k = 0; k < EDML_PAIRS; k++) between[k] = distance[k];
    const int steps_taken = refine(x, between, objective, steps, &work);
    copy(&out[0].x, x);
    *taken = tally;
    return steps_taken;
}
