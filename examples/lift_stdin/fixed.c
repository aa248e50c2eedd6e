/* The lift in fixed point: everything between the numbers read and the numbers printed is done in
 * whole numbers, as on a core without an FPU.
 *
 * SPDX-License-Identifier: MIT
 */
#include "lift_stdin.h"

/* Saturates, as hardware does: NaN and infinity become what edml_lift_q24() calls not finite. */
static int32_t saturate(double value, double low, double high)
{
    if (!(value > low)) return (int32_t)low;
    if (value >= high) return (int32_t)high;
    return (int32_t)(value < 0 ? value - 0.5 : value + 0.5);
}

static edml_keypoint_q16 to_q16(edml_keypoint in)
{
    edml_keypoint_q16 out;
    out.x = saturate(65536.0 * (double)in.x, INT32_MIN, INT32_MAX);
    out.y = saturate(65536.0 * (double)in.y, INT32_MIN, INT32_MAX);
    out.c = in.c > 0 ? (int16_t)saturate(32767.0 * (double)in.c, 1, INT16_MAX) : 0;
    if (!(in.c <= 0 || in.c > 0)) { /* NaN: nothing in this joint is known */
        out.x = INT32_MIN;
        out.c = 1;
    }
    return out;
}

static float to_float(int32_t value) { return (float)(value / 65536.0); }

edml_status lift_fixed(edml_pose *pose, const edml_keypoint in[], const options *set)
{
    edml_keypoint_q16 whole[KEYPOINTS_MAX], joints[EDML_JOINTS];
    edml_pose_q16 lifted;
    edml_work_q24 work;
    for (int n = 0; n < keypoints_of(set); n++) whole[n] = to_q16(in[n]);
    if (set->format != NULL) edml_adapt_q16(joints, whole, set->format);
    const edml_status status =
        edml_lift_q24(&lifted, set->format != NULL ? joints : whole, set->model, &work);
    if (status != EDML_OK) return status;
    for (int j = 0; j < EDML_JOINTS; j++) {
        pose->joint[j].x = to_float(lifted.joint[j].x);
        pose->joint[j].y = to_float(lifted.joint[j].y);
        pose->joint[j].z = to_float(lifted.joint[j].z);
    }
    pose->mirror_margin = to_float(lifted.mirror_margin);
    pose->residual = to_float(lifted.residual);
    pose->seen = lifted.seen;
    return EDML_OK;
}
