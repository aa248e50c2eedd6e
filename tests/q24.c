/* SPDX-License-Identifier: MIT */
#include "q24.h"

#include <math.h>
#include <string.h>

#define ONE 16777216.0 /* of Q24 */

static int32_t saturate(double value, double low, double high)
{
    if (!(value > low)) return (int32_t)low; /* NaN too */
    return value < high ? (int32_t)floor(value + 0.5) : (int32_t)high;
}

static int32_t q24(float value) { return saturate(ONE * (double)value, INT32_MIN, INT32_MAX); }

static float to_float(int32_t value) { return (float)(value / ONE); }

static void all_q24(int32_t *out, const float *values, int count)
{
    for (int n = 0; n < count; n++) out[n] = q24(values[n]);
}

static void all_floats(float *out, const int32_t *values, int count)
{
    for (int n = 0; n < count; n++) out[n] = to_float(values[n]);
}

void to_q16(edml_keypoint_q16 out[EDML_JOINTS], const edml_keypoint in[EDML_JOINTS])
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        out[j].x = saturate(65536.0 * (double)in[j].x, INT32_MIN, INT32_MAX);
        out[j].y = saturate(65536.0 * (double)in[j].y, INT32_MIN, INT32_MAX);
        out[j].c = (int16_t)saturate(32768.0 * (double)in[j].c, INT16_MIN, INT16_MAX);
    }
}

static edml_work_q24 memory;
static int32_t values[EDML_PAIRS];
static edml_point_q24 points[EDML_JOINTS];
static edml_keypoint_q16 keypoints[EDML_JOINTS];

edml_status q24_edm(float edm[EDML_PAIRS], const edml_keypoint in[EDML_JOINTS], int fewest,
                    float widest)
{
    to_q16(keypoints, in);
    const edml_status status = edml_edm_q24(values, keypoints, fewest, q24(widest));
    if (status == EDML_OK) all_floats(edm, values, EDML_PAIRS);
    return status;
}

void q24_net(float distance[EDML_PAIRS], const float edm[EDML_PAIRS], const edml_model *model,
             edml_work *work)
{
    (void)work;
    all_q24(values, edm, EDML_PAIRS);
    edml_net_q24(values, values, model, &memory);
    all_floats(distance, values, EDML_PAIRS);
}

void q24_jacobi(edml_eigen_f32 *eigen, const edml_matrix_f32 *a)
{
    static edml_matrix_q24 matrix;
    static edml_eigen_q24 found;
    for (int i = 0; i < EDML_JOINTS; i++) /* below the diagonal there may be anything */
        all_q24(&matrix.at[i][i], &a->at[i][i], EDML_JOINTS - i);
    edml_jacobi_q24(&found, &matrix);
    all_floats(eigen->value, found.value, EDML_JOINTS);
    for (int k = 0; k < EDML_JOINTS; k++)
        all_floats(eigen->vector[k], found.vector[k], EDML_JOINTS);
}

void q24_mds(edml_point x[EDML_JOINTS], const float distance[EDML_PAIRS], edml_work *work)
{
    (void)work;
    all_q24(values, distance, EDML_PAIRS);
    edml_mds_q24(points, values, &memory);
    all_floats(&x->x, &points->x, 3 * EDML_JOINTS);
}

int q24_refine(edml_point x[EDML_JOINTS], const float distance[EDML_PAIRS],
               edml_objective objective, int steps, edml_work *work)
{
    (void)work;
    all_q24(values, distance, EDML_PAIRS);
    all_q24(&points->x, &x->x, 3 * EDML_JOINTS);
    const int taken = edml_refine_q24(points, values, objective, steps, &memory);
    all_floats(&x->x, &points->x, 3 * EDML_JOINTS);
    return taken;
}

float q24_stress(const edml_point x[EDML_JOINTS], const float distance[EDML_PAIRS],
                 edml_objective objective)
{
    all_q24(values, distance, EDML_PAIRS);
    all_q24(&points->x, &x->x, 3 * EDML_JOINTS);
    return to_float(edml_stress_q24(points, values, objective));
}

float q24_mirror(edml_point x[EDML_JOINTS], const edml_model *model)
{
    all_q24(&points->x, &x->x, 3 * EDML_JOINTS);
    const int32_t margin = edml_mirror_q24(points, model);
    all_floats(&x->x, &points->x, 3 * EDML_JOINTS);
    return to_float(margin);
}

void q24_orient(edml_point x[EDML_JOINTS], const edml_keypoint in[EDML_JOINTS], uint16_t seen)
{
    to_q16(keypoints, in);
    all_q24(&points->x, &x->x, 3 * EDML_JOINTS);
    edml_orient_q24(points, keypoints, seen);
    all_floats(&x->x, &points->x, 3 * EDML_JOINTS);
}

edml_status q24_lift(edml_pose *pose, const edml_keypoint in[EDML_JOINTS], const edml_model *model,
                     edml_work *work)
{
    edml_pose_q16 lifted;
    if (in != NULL) to_q16(keypoints, in);
    const edml_status status = edml_lift_q24(pose != NULL ? &lifted : NULL, in != NULL ? keypoints : NULL,
                                             model, work != NULL ? &memory : NULL);
    if (status != EDML_OK) return status;
    for (int j = 0; j < EDML_JOINTS; j++) {
        pose->joint[j].x = (float)(lifted.joint[j].x / 65536.0);
        pose->joint[j].y = (float)(lifted.joint[j].y / 65536.0);
        pose->joint[j].z = (float)(lifted.joint[j].z / 65536.0);
    }
    pose->mirror_margin = (float)(lifted.mirror_margin / 65536.0);
    pose->residual = (float)(lifted.residual / 65536.0);
    pose->seen = lifted.seen;
    return status;
}

/* At most 33 keypoints, in sets of 14 for to_q16(). */
void q24_adapt(edml_keypoint out[EDML_JOINTS], const edml_keypoint in[], const edml_format *format)
{
    edml_keypoint_q16 wide[3 * EDML_JOINTS], joint[EDML_JOINTS];
    edml_keypoint padded[3 * EDML_JOINTS] = {{0, 0, 0}};
    memcpy(padded, in, format->keypoints * sizeof *in);
    for (int n = 0; n < 3; n++) to_q16(wide + n * EDML_JOINTS, padded + n * EDML_JOINTS);
    edml_adapt_q16(joint, wide, format);
    for (int j = 0; j < EDML_JOINTS; j++) {
        out[j].x = (float)(joint[j].x / 65536.0);
        out[j].y = (float)(joint[j].y / 65536.0);
        out[j].c = (float)(joint[j].c / 32768.0);
    }
}
