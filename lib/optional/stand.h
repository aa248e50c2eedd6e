/* Upright and on the floor.
 *
 * SPDX-License-Identifier: MIT
 */

/* Metres from the floor to the ankle of a foot that stands on it, in CMU's skeletons:
 * tools/fit_person.py. */
#define ANKLE REAL(0.07)

/* Unit vector, of a vector in any unit; 0 if it has no direction. */
static int unit_of(point *out, placed_point a)
{
    reported largest = ABS(a.x);
    if (ABS(a.y) > largest) largest = ABS(a.y);
    if (ABS(a.z) > largest) largest = ABS(a.z);
    if (!(largest > 0)) return 0;
    const point p = {DIV(a.x, largest), DIV(a.y, largest), DIV(a.z, largest)};
    *out = over(p, norm(p));
    return 1;
}

/* The camera's x, turned by the smallest rotation that brings the image's upwards to the unit vector
 * `up`; of a camera held upside down, which has none, by the one from the image's downwards. */
static point right_of(point up)
{
    const real side = up.y > 0 ? -REAL(1.0) : REAL(1.0);
    const real share = DIV(up.x, REAL(1.0) + ABS(up.y));
    const point right = {MUL(side, REAL(1.0) - MUL(share, up.x)), up.x,
                         -MUL(side, MUL(share, up.z))};
    return right;
}

edml_status NAME(edml_floor)(placed_point out[EDML_JOINTS], const pose *given, placed_point up)
{
    if (out == NULL || given == NULL) return EDML_ERR_ARGUMENT;
    if (!(FINITE(up.x) && FINITE(up.y) && FINITE(up.z))) return EDML_ERR_NOT_FINITE;
    if (!is_pose(given)) return EDML_ERR_NOT_FINITE;
    point y;
    if (!unit_of(&y, up)) return EDML_ERR_DEGENERATE;
    const point x = right_of(y), z = cross(x, y);
    const real right = dot(y, given_joint(given, EDML_R_ANKLE)); /* within 7 m */
    const real left = dot(y, given_joint(given, EDML_L_ANKLE));
    const real floor = (right < left ? right : left) - ANKLE;
    for (int j = 0; j < EDML_JOINTS; j++) {
        const point p = given_joint(given, j);
        const point upright = {dot(x, p), dot(y, p) - floor, dot(z, p)};
        out[j] = result(upright);
    }
    return EDML_OK;
}
