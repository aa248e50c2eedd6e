/* Moving points: their mean, and the origin that a pose has.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_CENTRE_H
#define EDML_CENTRE_H

#include "seen.h"
#include "vector.h"

/* Mean of the seen joints. */
static point mean_joint(const point x[EDML_JOINTS], uint16_t seen)
{
    point sum = {0, 0, 0};
    const real count = (real)count_seen(seen);
    for (int j = 0; j < EDML_JOINTS; j++)
        if (is_seen(seen, j)) sum = plus(sum, x[j]);
    const point mean = {sum.x / count, sum.y / count, sum.z / count};
    return mean;
}

static void move_origin_to_mean(point x[EDML_JOINTS])
{
    const point mean = mean_joint(x, ALL_JOINTS);
    for (int j = 0; j < EDML_JOINTS; j++) {
        x[j] = minus(x[j], mean);
        ASSUME(ALL_WITHIN(x[j], REAL(6.0))); /* each within 3 before, or about their mean already */
    }
}

static void move_origin_to_mid_hip(point x[EDML_JOINTS])
{
    const point mid_hip = midpoint(x[EDML_R_HIP], x[EDML_L_HIP]);
    for (int j = 0; j < EDML_JOINTS; j++) x[j] = minus(x[j], mid_hip);
}

#endif
