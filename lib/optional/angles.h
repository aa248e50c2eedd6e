/* The angles of a pose's joints, as far as 14 points tell them.
 *
 * Axes of parts of the body and the order of rotations follow the recommendations of the International Society
 * of Biomechanics: Wu et al., J. Biomech. 35 (2002) for the hip, 38 (2005) for the shoulder.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_MEASURE_ANGLES_H
#define EDML_MEASURE_ANGLES_H

#include "../api/pose.h"
#include "../geometry/angle.h"
#include "../geometry/matrix3.h"
#include "../geometry/unit_vector.h"

/* The least share of a unit vector in the plane in which its angle is measured: 14.5 degrees from the
 * perpendicular.  Below, small errors of joints make large ones of the angle. */
#define LEAST_SHARE REAL(0.25)

/* Which joints, as in pose->seen. */
enum {
    HIP_JOINTS = 1 << EDML_R_HIP | 1 << EDML_L_HIP,
    TRUNK_JOINTS = 1 << EDML_NECK_BASE | HIP_JOINTS,
    SHOULDER_JOINTS = 1 << EDML_R_SHOULDER | 1 << EDML_L_SHOULDER
};

static int sees_all(const edml_pose *pose, int joints) { return (pose->seen & joints) == joints; }

/* Zero if there is no length.  Joints are up to 14 m apart. */
static point towards(const edml_pose *pose, int from, int to)
{
    return direction(minus(pose_joint(pose, to), pose_joint(pose, from)));
}

/* From between the hips to the neck base. */
static point along_trunk(const edml_pose *pose)
{
    const point root = midpoint(pose_joint(pose, EDML_R_HIP), pose_joint(pose, EDML_L_HIP));
    return direction(minus(pose_joint(pose, EDML_NECK_BASE), root));
}

static int has_direction(point unit) { return dot(unit, unit) > EPSILON; }

/* Axes of a part of the body: x forward, y up, z to the subject's right.  Of the unit vectors y and z, which
 * are not quite at a right angle, z is moved.  Returns 0 if they are nearly parallel, or zero. */
static int upright_axes(matrix3 *axes, point y, point z)
{
    const point ahead = cross(y, z);
    if (!(norm(ahead) > LEAST_SHARE)) return 0;
    axes->x = direction(ahead);
    axes->y = y;
    axes->z = cross(axes->x, y);
    return 1;
}

/* The same; y is moved. */
static int level_axes(matrix3 *axes, point y, point z)
{
    const point ahead = cross(y, z);
    if (!(norm(ahead) > LEAST_SHARE)) return 0;
    axes->x = direction(ahead);
    axes->y = cross(z, axes->x);
    axes->z = z;
    return 1;
}

/* Of a part of a unit vector in a plane; none if that is short. */
static api_real angle_in_plane(real sine, real cosine)
{
    return HYPOT(sine, cosine) > LEAST_SHARE ? degrees_of(sine, cosine) : NO_ANGLE;
}

/* The same, from -90 to 270: an arm that points up and a little back has 185, and not -175. */
static api_real arm_angle(real sine, real cosine)
{
    return HYPOT(sine, cosine) > LEAST_SHARE ? QUARTER_TURN + degrees_of(-cosine, sine) : NO_ANGLE;
}

/* Between two unit vectors: 0 to 180. */
static api_real angle_between(point a, point b)
{
    if (!has_direction(a) || !has_direction(b)) return NO_ANGLE;
    return degrees_of(norm(cross(a, b)), dot(a, b));
}

/* How far the second of three joints in a row is bent. */
static api_real hinge_angle(const edml_pose *pose, int first)
{
    if (!sees_all(pose, 7 << first)) return NO_ANGLE;
    return angle_between(towards(pose, first, first + 1), towards(pose, first + 1, first + 2));
}

/* Rotation about the pelvis's z, then abduction from its sagittal plane.  side: 0 right, 1 left. */
static void measure_hips(api_real degrees[EDML_ANGLES], const edml_pose *pose)
{
    matrix3 pelvis;
    if (!sees_all(pose, TRUNK_JOINTS)) return;
    const point across = towards(pose, EDML_L_HIP, EDML_R_HIP);
    if (!level_axes(&pelvis, along_trunk(pose), across)) return;
    for (int side = 0; side < 2; side++) {
        const int hip = side == 0 ? EDML_R_HIP : EDML_L_HIP;
        const point thigh = rotate(&pelvis, towards(pose, hip, hip + 1));
        if (!sees_all(pose, 3 << hip) || !has_direction(thigh)) continue;
        const real outward = side == 0 ? thigh.z : -thigh.z;
        degrees[EDML_R_HIP_FLEXION + side] = angle_in_plane(thigh.x, -thigh.y);
        degrees[EDML_R_HIP_ABDUCTION + side] = degrees_of(outward, HYPOT(thigh.x, thigh.y));
    }
}

/* Plane of elevation and elevation, from the thorax; and the arm's shadows on the sagittal and the frontal
 * plane. */
static void measure_shoulders(api_real degrees[EDML_ANGLES], const edml_pose *pose)
{
    matrix3 thorax;
    if (!sees_all(pose, TRUNK_JOINTS | SHOULDER_JOINTS)) return;
    const point across = towards(pose, EDML_L_SHOULDER, EDML_R_SHOULDER);
    if (!upright_axes(&thorax, along_trunk(pose), across)) return;
    for (int side = 0; side < 2; side++) {
        const int shoulder = side == 0 ? EDML_R_SHOULDER : EDML_L_SHOULDER;
        const point arm = rotate(&thorax, towards(pose, shoulder, shoulder + 1));
        if (!sees_all(pose, 3 << shoulder) || !has_direction(arm)) continue;
        const real outward = side == 0 ? arm.z : -arm.z;
        degrees[EDML_R_SHOULDER_ELEVATION + side] = degrees_of(HYPOT(arm.x, outward), -arm.y);
        degrees[EDML_R_SHOULDER_PLANE + side] = angle_in_plane(arm.x, outward);
        degrees[EDML_R_SHOULDER_FLEXION + side] = arm_angle(arm.x, -arm.y);
        degrees[EDML_R_SHOULDER_ABDUCTION + side] = arm_angle(outward, -arm.y);
    }
}

/* From the left to the right side of the torso, of both shoulders and hips: up to 28 m before it is divided. */
static point across_torso(const edml_pose *pose)
{
    const point right = plus(pose_joint(pose, EDML_R_SHOULDER), pose_joint(pose, EDML_R_HIP));
    const point left = plus(pose_joint(pose, EDML_L_SHOULDER), pose_joint(pose, EDML_L_HIP));
    return direction(minus(right, left));
}

/* Which way x, at a right angle to up, points: 0 to the camera, 90 to the image's right. */
static api_real heading_of(point x, point up)
{
    const point to_camera = {0, 0, -REAL(1.0)};
    const point right = cross(up, to_camera);
    if (!(norm(right) > LEAST_SHARE)) return NO_ANGLE;
    return degrees_of(dot(x, right), dot(x, cross(right, up)));
}

/* Rotation about the trunk's horizontal axis to the right, then sideways. */
static void measure_trunk(api_real degrees[EDML_ANGLES], const edml_pose *pose, point up)
{
    matrix3 upright;
    const point trunk = along_trunk(pose);
    if (sees_all(pose, TRUNK_JOINTS)) degrees[EDML_TRUNK_LEAN] = angle_between(trunk, up);
    if (!sees_all(pose, SHOULDER_JOINTS | HIP_JOINTS) || !upright_axes(&upright, up, across_torso(pose)))
        return;
    degrees[EDML_HEADING] = heading_of(upright.x, up);
    if (!sees_all(pose, TRUNK_JOINTS) || !has_direction(trunk)) return;
    const point leaning = rotate(&upright, trunk);
    degrees[EDML_TRUNK_LEAN_FORWARD] = angle_in_plane(leaning.x, leaning.y);
    degrees[EDML_TRUNK_LEAN_RIGHT] = degrees_of(leaning.z, HYPOT(leaning.x, leaning.y));
}

edml_status edml_angles(api_real degrees[EDML_ANGLES], const edml_pose *pose, const edml_point *up)
{
    if (degrees == NULL || pose == NULL) return EDML_ERR_ARGUMENT;
    if (!is_pose(pose)) return EDML_ERR_NOT_FINITE;
    point vertical = {0, -REAL(1.0), 0}; /* of a level camera */
    const edml_status status = up != NULL ? unit_vector(&vertical, *up) : EDML_OK;
    if (status != EDML_OK) return status;
    for (int n = 0; n < EDML_ANGLES; n++) degrees[n] = NO_ANGLE;
    degrees[EDML_R_ELBOW_FLEXION] = hinge_angle(pose, EDML_R_SHOULDER);
    degrees[EDML_L_ELBOW_FLEXION] = hinge_angle(pose, EDML_L_SHOULDER);
    degrees[EDML_R_KNEE_FLEXION] = hinge_angle(pose, EDML_R_HIP);
    degrees[EDML_L_KNEE_FLEXION] = hinge_angle(pose, EDML_L_HIP);
    measure_hips(degrees, pose);
    measure_shoulders(degrees, pose);
    measure_trunk(degrees, pose, vertical);
    return EDML_OK;
}

#endif
