/* How good is a pose?  A logistic model of what it shows, with a sigmoid that
 * needs no exponential.
 *
 * tools/fitting/body.py fits these numbers; they belong to the shipped networks.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_QUALITY_H
#define EDML_QUALITY_H

#include "../api/pose.h"
#include "../geometry/seen.h"
#include "../geometry/vector.h"

/* The lengths that people's bones have, metres. */
static const struct {
    real min, max;
} bone_range[EDML_BONES] = {
    {REAL(0.25), REAL(0.33)},                                                     /* head */
    {REAL(0.17), REAL(0.22)}, {REAL(0.21), REAL(0.32)}, {REAL(0.20), REAL(0.32)}, /* right arm */
    {REAL(0.17), REAL(0.22)}, {REAL(0.21), REAL(0.32)}, {REAL(0.20), REAL(0.32)},
    {REAL(0.39), REAL(0.52)}, {REAL(0.36), REAL(0.45)}, {REAL(0.37), REAL(0.47)}, /* trunk, leg */
    {REAL(0.39), REAL(0.52)}, {REAL(0.36), REAL(0.45)}, {REAL(0.37), REAL(0.47)},
};

/* Weights, and the limits that their inputs are clamped to. */
#define PER_MISFIT REAL(20.031)   /* a metre */
#define MAX_METRES REAL(0.5)      /* of it */
#define PER_MISSING REAL(0.422)   /* a joint */
#define MAX_MISSING 4             /* joints; the networks need the others */
#define PER_VIOLATION REAL(7.154) /* a metre */
#define MAX_VIOLATION REAL(4.0)   /* metres, of all bones */
#define PER_SIDE REAL(0.850)      /* seen from the side, not from the front */
#define QUALITY_CONSTANT REAL(2.814)

static real clamp_to(api_real a, real limit) { return a < TO_API(limit) ? FROM_API(a) : limit; }

/* Metres by which bones are shorter or longer than people's: their sum. */
static real length_violation(const edml_pose *pose)
{
    real sum = 0;
    for (int n = 0; n < EDML_BONES; n++) {
        const real length = norm(
            minus(pose_joint(pose, edml_bones[n].to), pose_joint(pose, edml_bones[n].from)));
        if (length < bone_range[n].min) sum += bone_range[n].min - length;
        if (length > bone_range[n].max) sum += length - bone_range[n].max;
        if (sum > MAX_VIOLATION) return MAX_VIOLATION; /* before the next one, of up to 14 m */
    }
    return sum;
}

/* How far the person is seen from the side: the share along the line of sight of the line from the torso's
 * right to its left, 0 to 1.  Depths are surer then. */
static real side_view(const edml_pose *pose)
{
    const point left = plus(pose_joint(pose, EDML_L_SHOULDER), pose_joint(pose, EDML_L_HIP));
    const point right = plus(pose_joint(pose, EDML_R_SHOULDER), pose_joint(pose, EDML_R_HIP));
    return ABS(direction(minus(left, right)).z); /* |left|, |right| <= 14 */
}

edml_status edml_quality(api_real *quality, const edml_pose *pose)
{
    if (quality == NULL || pose == NULL) return EDML_ERR_ARGUMENT;
    const int missing = EDML_JOINTS - count_seen(pose->seen);
    if (!is_pose(pose)) return EDML_ERR_NOT_FINITE;
    if (!(pose->misfit >= 0)) return EDML_ERR_ARGUMENT;
    if (missing > MAX_MISSING) return EDML_ERR_TOO_FEW_JOINTS;
    const real misfit = clamp_to(pose->misfit, MAX_METRES);
    const real score = QUALITY_CONSTANT - MUL(PER_MISFIT, misfit) - (real)missing * PER_MISSING -
                       MUL(PER_VIOLATION, length_violation(pose)) + MUL(PER_SIDE, side_view(pose));
    /* |score| <= 55 */
    *quality = TO_API((REAL(1.0) + DIV(score, HYPOT(REAL(1.0), score))) / 2);
    return EDML_OK;
}

#endif
