/* Stands a pose upright on the floor.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_STAND_H
#define EDML_STAND_H

#include "../api/pose.h"
#include "../geometry/unit_vector.h"

/* Metres from the floor to the ankle of a foot that stands on it, in CMU's skeletons:
 * tools/fitting/body.py. */
#define ANKLE_HEIGHT REAL(0.07)

/* The camera's x after the smallest rotation that brings the image's up to the unit vector `up`.  For an
 * upside-down camera that rotation is undefined: it starts from the image's down. */
static point horizontal_right(point up)
{
    const real side = up.y > 0 ? -REAL(1.0) : REAL(1.0);
    const real ratio = DIV(up.x, REAL(1.0) + ABS(up.y));
    const point right = {MUL(side, REAL(1.0) - MUL(ratio, up.x)), up.x, -MUL(side, MUL(ratio, up.z))};
    return right;
}

edml_status edml_stand(edml_point out[EDML_JOINTS], const edml_pose *pose, edml_point up)
{
    if (out == NULL || pose == NULL) return EDML_ERR_ARGUMENT;
    if (!is_pose(pose)) return EDML_ERR_NOT_FINITE;
    point y;
    const edml_status status = unit_vector(&y, up);
    if (status != EDML_OK) return status;
    const point x = horizontal_right(y), z = cross(x, y);
    const real right = dot(y, pose_joint(pose, EDML_R_ANKLE)); /* within 7 m */
    const real left = dot(y, pose_joint(pose, EDML_L_ANKLE));
    const real floor = (right < left ? right : left) - ANKLE_HEIGHT;
    for (int j = 0; j < EDML_JOINTS; j++) {
        const point p = pose_joint(pose, j);
        const point upright = {dot(x, p), dot(y, p) - floor, dot(z, p)};
        out[j] = api_point(upright);
    }
    return EDML_OK;
}

#endif
