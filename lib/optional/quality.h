/* How good is a pose?  A logistic model of what the pose and its image show, with a sigmoid that
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
    {REAL(0.18), REAL(0.22)}, {REAL(0.21), REAL(0.32)}, {REAL(0.20), REAL(0.32)}, /* right arm */
    {REAL(0.18), REAL(0.22)}, {REAL(0.21), REAL(0.32)}, {REAL(0.20), REAL(0.32)},
    {REAL(0.39), REAL(0.50)}, {REAL(0.37), REAL(0.44)}, {REAL(0.37), REAL(0.47)}, /* trunk, leg */
    {REAL(0.39), REAL(0.50)}, {REAL(0.37), REAL(0.44)}, {REAL(0.37), REAL(0.47)},
};

/* Weights, and the limits that their inputs are clamped to. */
#define PER_MARGIN REAL(0.427)
#define MAX_MARGIN REAL(2.0)
#define PER_RESIDUAL REAL(17.418) /* a metre */
#define PER_MISFIT REAL(23.256)   /* a metre */
#define MAX_METRES REAL(0.5)      /* of either */
#define PER_MISSING REAL(0.551)   /* a joint */
#define MAX_MISSING 4             /* joints; the networks need the others */
#define PER_VIOLATION REAL(6.757) /* a metre */
#define MAX_VIOLATION REAL(4.0)   /* metres, of all bones */
#define QUALITY_CONSTANT REAL(2.351)

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

/* Farthest coordinate of the image from the first one. */
static pixels reach_from(edml_keypoint first, const edml_keypoint in[EDML_JOINTS], uint16_t seen)
{
    pixels reach = 0; /* <= 2^30 */
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (!is_seen(seen, j)) continue;
        if (ABS(in[j].x - first.x) > reach) reach = ABS(in[j].x - first.x);
        if (ABS(in[j].y - first.y) > reach) reach = ABS(in[j].y - first.y);
    }
    return reach;
}

/* RMS difference in metres of the seen joints from the image, at its best scale and place; `limit` if
 * it is more, or if the image is a point. */
static real image_misfit(const edml_pose *pose, const edml_keypoint in[EDML_JOINTS], uint16_t seen,
                         real limit)
{
    int first = 0;
    while (!is_seen(seen, first)) first++;
    const pixels reach = reach_from(in[first], in, seen);
    if (!(reach > 0)) return limit;
    const real part = REAL(1.0) / (real)count_seen(seen);
    point p_mean = {0, 0, 0}, q_mean = {0, 0, 0};
    real pp = 0, pq = 0, qq = 0; /* means: <= 32, 8 and 2 */
    for (int j = first; j < EDML_JOINTS; j++) {
        if (!is_seen(seen, j)) continue;
        const point at = pose_joint(pose, j), p = {at.x, at.y, 0};
        const point q = {DIV(in[j].x - in[first].x, reach), DIV(in[j].y - in[first].y, reach), 0};
        add_multiple(&p_mean, part, p);
        add_multiple(&q_mean, part, q);
        pp += MUL(part, dot(p, p));
        pq += MUL(part, dot(p, q));
        qq += MUL(part, dot(q, q));
    }
    pp -= dot(p_mean, p_mean);
    pq -= dot(p_mean, q_mean);
    qq -= dot(q_mean, q_mean); /* >= 1 / 28: a joint is 1 away from the first */
    const real square = pq > 0 ? pp - MUL(DIV(pq, qq), pq) : pp; /* pq / qq <= sqrt(pp / qq) */
    if (!(square < MUL(limit, limit))) return limit;             /* also NaN */
    return square > 0 ? SQRT(square) : 0;
}

edml_status edml_quality(api_real *quality, const edml_pose *pose, const edml_keypoint in[EDML_JOINTS])
{
    if (quality == NULL || pose == NULL || in == NULL) return EDML_ERR_ARGUMENT;
    const uint16_t seen = seen_joints(in);
    const int missing = EDML_JOINTS - count_seen(seen);
    if (!is_pose(pose) || !are_finite(in, seen)) return EDML_ERR_NOT_FINITE;
    if (!(pose->mirror_margin >= 0 && pose->residual >= 0)) return EDML_ERR_ARGUMENT;
    if (missing > MAX_MISSING) return EDML_ERR_TOO_FEW_JOINTS;
    const real margin = clamp_to(pose->mirror_margin, MAX_MARGIN);
    const real residual = clamp_to(pose->residual, MAX_METRES);
    const real misfit = image_misfit(pose, in, seen, MAX_METRES);
    const real score = QUALITY_CONSTANT + MUL(PER_MARGIN, margin) - MUL(PER_RESIDUAL, residual) -
                       MUL(PER_MISFIT, misfit) - (real)missing * PER_MISSING -
                       MUL(PER_VIOLATION, length_violation(pose));
    /* |score| <= 55 */
    *quality = TO_API((REAL(1.0) + DIV(score, HYPOT(REAL(1.0), score))) / 2);
    return EDML_OK;
}

#endif
