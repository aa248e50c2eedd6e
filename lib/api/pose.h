/* A pose that was given: is it one?  Its joints.
 *
 * SPDX-License-Identifier: MIT
 */

#define LARGEST REAL(4.0) /* |coordinate| of a pose, metres */
#define WITHIN(a) ((a) < RESULT(LARGEST) && (a) > -RESULT(LARGEST)) /* NaN is not */

static int is_pose(const pose *given)
{
    for (int j = 0; j < EDML_JOINTS; j++)
        if (!WITHIN(given->joint[j].x) || !WITHIN(given->joint[j].y) || !WITHIN(given->joint[j].z))
            return 0;
    return 1;
}

/* Joint of the pose, metres. */
static point given_joint(const pose *given, int j)
{
    const point p = {GIVEN(given->joint[j].x), GIVEN(given->joint[j].y), GIVEN(given->joint[j].z)};
    return p;
}

static placed_point result(point p)
{
    const placed_point q = {RESULT(p.x), RESULT(p.y), RESULT(p.z)};
    return q;
}
