/* For tests of both arithmetics whose text is in the arithmetic's own numbers: float32 or, compiled with
 * -DEDML_TEST_Q24, fixed point.  Names and words are those of the texts in lib/ (lib/api/api_f32.h): edml_lift()
 * is edml_lift_q() here, and edml_pose is edml_pose_q.  Types and functions that end in _f32 are float in
 * either.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_TEST_NATIVE_H
#define EDML_TEST_NATIVE_H

#include "helpers.h"

typedef edml_point point_f32;
typedef edml_keypoint keypoint_f32;
typedef edml_pose pose_f32;
typedef edml_work work_f32;

static inline edml_status lift_f32(pose_f32 *pose, const keypoint_f32 in[EDML_JOINTS], const point_f32 *up,
                                   const edml_model *model, work_f32 *work)
{
    return edml_lift(pose, in, up, model, work, sizeof *work);
}

static inline int refine_f32(point_f32 x[EDML_JOINTS], const float distance[EDML_PAIRS],
                             edml_objective objective, int steps, work_f32 *work)
{
    return edml_refine(x, distance, objective, steps, work);
}

static inline float stress_f32(const point_f32 x[EDML_JOINTS], const float distance[EDML_PAIRS],
                               edml_objective objective)
{
    return edml_stress(x, distance, objective);
}

#ifdef EDML_TEST_Q24

#include "api/api_q.h"

#define DIRECT edml_direct_w16
#define DISTANCES edml_distances_w16
#define FCONN edml_fconn_w16
#define FCONV edml_fconv_w8
#define PREDICT predict_q /* a model's network */
#define SET_PARAM(number, value) ((number).q24 = to_real(value))
#define edml_fconv_work edml_fconv_work_q
#define edml_model_work_bytes edml_model_work_bytes_q

static inline real to_real(float a) { return (real)lrint((double)a * 16777216.0); }
static inline float from_real(real a) { return (float)(a / 16777216.0); }
static inline pixels to_pixels(float a) { return (pixels)lrint((double)a * 65536.0); }
static inline float from_api(api_real a) { return (float)(a / 65536.0); }
static inline edml_point to_api_point(point_f32 p) { return point_to_q16(p); }

static inline void to_keypoints(edml_keypoint out[EDML_JOINTS], const keypoint_f32 in[EDML_JOINTS])
{
    to_q16(out, in);
}

#else

#include "api/api_f32.h"

#define DIRECT edml_direct_f32
#define DISTANCES edml_distances_f32
#define FCONN edml_fconn_f32
#define FCONV edml_fconv_f32
#define PREDICT predict_f32
#define SET_PARAM(number, value) ((number).f32 = (value))

static inline real to_real(float a) { return a; }
static inline float from_real(real a) { return a; }
static inline pixels to_pixels(float a) { return a; }
static inline float from_api(api_real a) { return a; }
static inline edml_point to_api_point(point_f32 p) { return p; }

static inline void to_keypoints(edml_keypoint out[EDML_JOINTS], const keypoint_f32 in[EDML_JOINTS])
{
    memcpy(out, in, EDML_JOINTS * sizeof *out);
}

#endif

static inline void to_points(point out[EDML_JOINTS], const point_f32 in[EDML_JOINTS])
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        out[j].x = to_real(in[j].x);
        out[j].y = to_real(in[j].y);
        out[j].z = to_real(in[j].z);
    }
}

static inline void from_points(point_f32 out[EDML_JOINTS], const point in[EDML_JOINTS])
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        out[j].x = from_real(in[j].x);
        out[j].y = from_real(in[j].y);
        out[j].z = from_real(in[j].z);
    }
}

static inline void to_reals(real *out, const float *in, int count)
{
    for (int n = 0; n < count; n++) out[n] = to_real(in[n]);
}

static inline void from_reals(float *out, const real *in, int count)
{
    for (int n = 0; n < count; n++) out[n] = from_real(in[n]);
}

static inline pose_f32 from_pose(const edml_pose *pose)
{
    pose_f32 out;
    memset(&out, 0, sizeof out);
    for (int j = 0; j < EDML_JOINTS; j++) {
        out.joint[j].x = from_api(pose->joint[j].x);
        out.joint[j].y = from_api(pose->joint[j].y);
        out.joint[j].z = from_api(pose->joint[j].z);
    }
    out.misfit = from_api(pose->misfit);
    out.seen = pose->seen;
    return out;
}

#endif
