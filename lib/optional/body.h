/* Gives a pose the known size of its body.
 *
 * Scaling the pose equals scaling the distance matrix, because the stages between them keep ratios.  Bones
 * of known length keep their direction, and the others their length; that brings joints nearer to the truth
 * than a refinement that weighs the known distances heavily (docs/body.md).
 *
 * tools/fitting/body.py measures the proportions.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_FIT_BODY_H
#define EDML_FIT_BODY_H

#include "../api/pose.h"
#include "../geometry/vector.h"

/* Relative to the standing height: each bone, the height itself; and the way from head to ankle along the
 * bones. */
static const real proportion[EDML_BONES + 1] = {
    REAL(0.165),                           /* head */
    REAL(0.113), REAL(0.168), REAL(0.159), /* right clavicle, upper arm, forearm */
    REAL(0.113), REAL(0.168), REAL(0.159), /* left */
    REAL(0.261), REAL(0.230), REAL(0.246), /* right trunk, thigh, shin */
    REAL(0.261), REAL(0.230), REAL(0.246), /* left */
    REAL(1.0),
};
#define HEAD_TO_ANKLE REAL(0.902)

#define MIN_HEIGHT REAL(0.5) /* metres, standing height */
#define MAX_HEIGHT REAL(2.5)
#define MAX_HEIGHT_RATIO                                                                                   \
    REAL(1.6) /* ratio of the heights that the bones of one person stand for; seen: 1.44 */

/* Limits of the factor for a whole pose.  Bones are 14 m long at most. */
enum { MAX_ENLARGEMENT = 2, MAX_REDUCTION = 8 };

enum { HEAD_BONE = 0, FIRST_LEG_BONE = 7 };

/* The standing height that a measure implies; 0 if no person has that. */
static real implied_height(api_real measure, real of_height)
{
    if (!(measure > 0 && measure < TO_API(POSE_REACH))) return 0; /* NaN is not */
    const real height = DIV(FROM_API(measure), of_height);        /* < 36 */
    return height >= MIN_HEIGHT && height <= MAX_HEIGHT ? height : 0;
}

/* Can one person have these measures? */
static int is_body(const edml_body *body)
{
    real least = MAX_HEIGHT, most = MIN_HEIGHT;
    for (int n = 0; n <= EDML_BONES; n++) {
        const api_real measure = n < EDML_BONES ? body->bone[n] : body->height;
        if (measure == 0) continue;
        const real height = implied_height(measure, proportion[n]);
        if (height == 0) return 0;
        if (height < least) least = height;
        if (height > most) most = height;
    }
    return most <= MUL(MAX_HEIGHT_RATIO, least);
}

/* The factor for bones of unknown length; 0 if the pose is far from the body's size. */
static real body_scale(api_real height, const real length[EDML_BONES])
{
    if (height == 0) return REAL(1.0);
    const real wanted = MUL(HEAD_TO_ANKLE, FROM_API(height));
    real has = length[HEAD_BONE]; /* <= 4 * 14 */
    for (int n = FIRST_LEG_BONE; n < EDML_BONES; n++) has += length[n] / 2;
    return wanted / (int)MAX_ENLARGEMENT <= has && has / (int)MAX_REDUCTION <= wanted ? DIV(wanted, has) : 0;
}

/* Joints about the neck: the body's bones in the directions of the pose's.  Returns 0 if a bone has no
 * direction, or if the pose's size is far off.  No joint is more than 3 * 2 * 8 m from the neck, along an
 * axis. */
static int resize_bones(point y[EDML_JOINTS], const point x[EDML_JOINTS], const edml_body *body)
{
    real length[EDML_BONES];
    for (int n = 0; n < EDML_BONES; n++)
        length[n] = norm(minus(x[edml_bones[n].to], x[edml_bones[n].from]));
    const real scale = body_scale(body->height, length);
    if (scale == 0) return 0;
    y[EDML_NECK_BASE] = minus(x[EDML_NECK_BASE], x[EDML_NECK_BASE]);
    for (int n = 0; n < EDML_BONES; n++) { /* from the neck outwards */
        const int to = edml_bones[n].to, from = edml_bones[n].from;
        const real known = FROM_API(body->bone[n]);
        if (known / 64 > length[n]) return 0;
        y[to] = y[from];
        add_multiple(&y[to], known != 0 ? DIV(known, length[n]) : scale, minus(x[to], x[from]));
    }
    return 1;
}

edml_status edml_fit_body(edml_pose *pose, const edml_body *body)
{
    if (pose == NULL || body == NULL) return EDML_ERR_ARGUMENT;
    if (!is_pose(pose)) return EDML_ERR_NOT_FINITE;
    if (!is_body(body)) return EDML_ERR_BODY;
    point x[EDML_JOINTS], y[EDML_JOINTS];
    for (int j = 0; j < EDML_JOINTS; j++) x[j] = pose_joint(pose, j);
    if (!resize_bones(y, x, body)) return EDML_ERR_DEGENERATE;
    const point root = times(REAL(0.5), plus(y[EDML_R_HIP], y[EDML_L_HIP]));
    for (int j = 0; j < EDML_JOINTS; j++) pose->joint[j] = api_point(minus(y[j], root));
    return EDML_OK;
}

#endif
