/* Poses as the public interface has them, to points and back.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_POSE_H
#define EDML_POSE_H

#include "api.h"

#define POSE_REACH REAL(4.0) /* |coordinate| of a pose is below this, metres */

/* false for NaN */
static inline int is_within_reach(api_real a) { return a < TO_API(POSE_REACH) && a > -TO_API(POSE_REACH); }

static inline int is_pose(const edml_pose *pose)
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        const edml_point *p = &pose->joint[j];
        if (!is_within_reach(p->x) || !is_within_reach(p->y) || !is_within_reach(p->z)) return 0;
    }
    return 1;
}

/* A joint of the pose, metres. */
static inline point pose_joint(const edml_pose *pose, int j)
{
    const edml_point *p = &pose->joint[j];
    const point q = {FROM_API(p->x), FROM_API(p->y), FROM_API(p->z)};
    return q;
}

static inline edml_point api_point(point p)
{
    const edml_point q = {TO_API(p.x), TO_API(p.y), TO_API(p.z)};
    return q;
}

#endif
