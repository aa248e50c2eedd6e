/* Lines of sight of a pinhole camera.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_LINE_OF_SIGHT_H
#define EDML_LINE_OF_SIGHT_H

#include "../../api/api.h"

#define MAX_TANGENT 2 /* of a ray to the camera's axis, along x and along y */

/* Can a camera have these numbers? */
static int is_camera(const edml_camera *camera)
{
    return IS_FINITE(camera->fx) && IS_FINITE(camera->fy) && IS_FINITE(camera->cx) &&
           IS_FINITE(camera->cy) && camera->fx > 0 && camera->fy > 0;
}

/* Where the line through a keypoint passes depth 1; returns 0 if that is too far off the axis. */
static int line_of_sight(point *ray, edml_keypoint at, const edml_camera *camera)
{
    const pixels x = at.x - camera->cx, y = at.y - camera->cy;
    if (ABS(x) / MAX_TANGENT > camera->fx || ABS(y) / MAX_TANGENT > camera->fy) return 0;
    /* |x| <= 2 fx + 1, which is 3 fx of the least */
    ray->x = DIV_TO(REAL(3.0), x, camera->fx);
    ray->y = DIV_TO(REAL(3.0), y, camera->fy);
    ray->z = REAL(1.0);
    return 1;
}

#endif
