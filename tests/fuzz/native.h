/* A target's text in the numbers of an arithmetic: float32 or, compiled with -DEDML_FUZZ_Q, fixed point.  Names and
 * words are those of the texts in lib/ (lib/api/api_f32.h): edml_lift() is edml_lift_q() here.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_FUZZ_NATIVE_H
#define EDML_FUZZ_NATIVE_H

#include <math.h>
#include <string.h>

#include "scene.h"

enum { ALL_SEEN = (1 << EDML_JOINTS) - 1 };

/* FUZZ_TARGET(x)      the name of the target in this arithmetic
 * IS_EXACT            does nothing get lost by a power of two and by a change of sign?
 * TINY, TINY_METRE    what rounding leaves: of numbers of about 1 within the library; of a pose's coordinate
 * from_real() ...     to double; to_real() ...: from double, at the ends of the range if beyond it
 * WATCH(status, call, a, b, size)  calls a function of tests/overflow: demands the same status, that no number
 *                     overflows and, if it is EDML_OK, the same bytes */
#ifdef EDML_FUZZ_Q

#include "api/api_q.h"
#include "overflow.h"

#define FUZZ_TARGET(name) fuzz_##name##_q
#define IS_EXACT 0
#define TINY 0x1p-20
#define TINY_METRE 0x1p-15
#define IS_NO_ANGLE(degrees) ((degrees) == EDML_NO_ANGLE)
#define edml_model_work_bytes edml_model_work_bytes_q
#define edml_fconv_work edml_fconv_work_q
#define FUZZ_MODELS                                                                                        \
    &edml_direct_w16, &edml_direct_w8, &edml_distances_w16, &edml_direct_w16, &edml_distances_w8,          \
        &edml_fconn_w16, &edml_direct_w8, &edml_fconn_w8
#define FUZZ_FCONV &edml_fconv_w8
#define WATCH(status, call, a, b, size)                                                                    \
    do {                                                                                                   \
        if (!fuzz_watches) break;                                                                          \
        checked_tally taken;                                                                               \
        REQUIRE((call) == (status), "another status of watched numbers");                                  \
        REQUIRE(taken.overflows == 0, "a number overflows");                                               \
        REQUIRE((status) != EDML_OK || memcmp(a, b, size) == 0, "not what watched numbers give");          \
    } while (0)

static inline int32_t to_fixed(double a, double unit)
{
    const double scaled = nearbyint(a * unit);
    return scaled >= INT32_MAX  ? INT32_MAX
           : scaled > INT32_MIN ? (int32_t)scaled
                                : INT32_MIN; /* also NaN */
}

static inline double from_real(real a) { return a / 16777216.0; }
static inline double from_api(api_real a) { return a / 65536.0; }
static inline double from_pixels(pixels a) { return a / 65536.0; }
static inline real to_real(double a) { return to_fixed(a, 16777216.0); }
static inline api_real to_api(double a) { return to_fixed(a, 65536.0); }
static inline pixels to_pixels(double a) { return to_fixed(a, 65536.0); }

static inline confidence to_confidence(double a)
{
    const double scaled = 32767 * a;
    return (confidence)(scaled > 32767 ? 32767 : scaled > -32768 ? scaled : -32768);
}

#else

#include "api/api_f32.h"

#define FUZZ_TARGET(name) fuzz_##name
#define IS_EXACT 1
#define TINY 0x1p-20
#define TINY_METRE 0x1p-20
#define IS_NO_ANGLE(degrees) isnan(degrees)
#define FUZZ_MODELS                                                                                        \
    &edml_direct_f32, &edml_direct_w16, &edml_distances_f32, &edml_direct_w16, &edml_distances_w16,        \
        &edml_fconn_f32, &edml_direct_w8, &edml_fconn_w16
#define FUZZ_FCONV &edml_fconv_f32
#define WATCH(status, call, a, b, size) (void)0

static inline double from_real(real a) { return (double)a; }
static inline double from_api(api_real a) { return (double)a; }
static inline double from_pixels(pixels a) { return (double)a; }
static inline real to_real(double a) { return (real)a; }
static inline api_real to_api(double a) { return (api_real)a; }
static inline pixels to_pixels(double a) { return (pixels)a; }
static inline confidence to_confidence(double a) { return (confidence)a; }

#endif

#include "network/model.h"

#define FUZZ_NAME(name) FUZZ_TARGET(name)
fuzz_target FUZZ_NAME(NAME_OF_THIS);

/* ---- In and out ------------------------------------------------------------------------------------ */

static inline void to_keypoints(edml_keypoint out[], const sighting in[], int count)
{
    for (int j = 0; j < count; j++) {
        memset(&out[j], 0, sizeof out[j]);
        out[j].x = to_pixels(in[j].x);
        out[j].y = to_pixels(in[j].y);
        out[j].c = to_confidence(in[j].c);
    }
}

static inline edml_point to_point(place3 p)
{
    const edml_point made = {to_api(p.x), to_api(p.y), to_api(p.z)};
    return made;
}

static inline place3 from_point(edml_point p)
{
    const place3 place = {from_api(p.x), from_api(p.y), from_api(p.z)};
    return place;
}

static inline void to_pose(edml_pose *pose, const place3 x[EDML_JOINTS], choices *from)
{
    memset(pose, 0, sizeof *pose);
    for (int j = 0; j < EDML_JOINTS; j++) pose->joint[j] = to_point(x[j]);
    pose->misfit = to_api(draw_one_in(from, 32) ? draw_extreme(from) : draw_between(from, 0, 0.2));
    pose->seen = (uint16_t)(draw_one_in(from, 4) ? draw_bits(from, 2) : ALL_SEEN);
}

static inline edml_camera to_camera(pinhole by)
{
    const edml_camera camera = {to_pixels(by.fx), to_pixels(by.fy), to_pixels(by.cx), to_pixels(by.cy)};
    return camera;
}

static inline const edml_model *draw_model(choices *from)
{
    static const edml_model *const models[] = {FUZZ_MODELS};
    return models[draw_below(from, sizeof models / sizeof *models)];
}

/* ---- What is demanded of several ------------------------------------------------------------------- */

static inline double distance_of(place3 a, place3 b)
{
    return sqrt((a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y) + (a.z - b.z) * (a.z - b.z));
}

static inline uint16_t seen_of(const edml_keypoint in[EDML_JOINTS])
{
    uint16_t seen = 0;
    for (int j = 0; j < EDML_JOINTS; j++) seen = (uint16_t)(seen | (in[j].c > 0) << j);
    return seen;
}

/* A pose of anything: finite, about mid-hip, and of the size that the limits leave (lib/lift/fuse.h): in the body's
 * frame a network's points are within 3 m along each axis, and a joint in the image within 3.9 m along two. */
#define LONGEST_BONE 12.6
static inline void check_pose_about(const edml_pose *pose, double off_mid_hip)
{
    place3 x[EDML_JOINTS];
    for (int j = 0; j < EDML_JOINTS; j++) {
        x[j] = from_point(pose->joint[j]);
        REQUIRE(fabs(x[j].x) + fabs(x[j].y) + fabs(x[j].z) < 16, "a joint is not near the hips");
    }
    for (int n = 0; n < EDML_BONES; n++)
        REQUIRE(distance_of(x[edml_bones[n].from], x[edml_bones[n].to]) <= LONGEST_BONE,
                "a bone is too long");
    const place3 left = {-x[EDML_L_HIP].x, -x[EDML_L_HIP].y, -x[EDML_L_HIP].z};
    REQUIRE(distance_of(x[EDML_R_HIP], left) <= off_mid_hip, "mid-hip is not the origin");
    REQUIRE(from_api(pose->misfit) >= 0 && from_api(pose->misfit) < 16, "a bad misfit");
}

static inline void check_pose(const edml_pose *pose) { check_pose_about(pose, 4 * TINY_METRE); }

static inline int are_same_poses(const edml_pose *a, const edml_pose *b)
{
    return memcmp(a, b, offsetof(edml_pose, seen)) == 0 && a->seen == b->seen;
}

#endif
