/* Joint limits (section 3.3, as the paper has it): bones that point where no training person's did.
 *
 * tools/fitting/joint_limits.py learns the maps.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_JOINT_LIMITS_H
#define EDML_JOINT_LIMITS_H

#include "../api/pose.h"
#include "../geometry/torso.h"
#include "joint_limit_maps.h"

/* Axes of the torso, unit vectors; all zero if it has no front. */
typedef struct {
    point side, up, front; /* side: toward the subject's left */
} torso_axes;

typedef struct {
    int row, column;
} map_cell;

static torso_axes torso_axes_of(const point x[EDML_JOINTS], int right, int left)
{
    const point front = forward(x, right, left);
    const point side = dot(front, front) > EPSILON ? direction(minus(x[left], x[right])) : front;
    const torso_axes axes = {side, cross(front, side), front};
    return axes;
}

/* The bone's components outward, up and forward.  Left bones are mirrored onto right ones, and a head that
 * leans to the right onto one that leans to the left. */
static point in_axes(torso_axes axes, point bone, int n)
{
    const point left = {dot(axes.side, bone), dot(axes.up, bone), dot(axes.front, bone)};
    const point right = {-left.x, left.y, left.z};
    return n == 0 ? (left.x < 0 ? right : left) : n % 2 != 0 ? right : left;
}

static int has_no_direction(point bone) { return !(dot(bone, bone) > EPSILON); }

/* The bone after the half rotation that brings its parent outward, down and forward: a straight limb points
 * there.  No parent points the opposite way, where that rotation is not smooth. */
static point unbent(point bone, point parent)
{
    const real third = REAL(0.57735026918962576); /* sqrt(1/3) */
    const point straight = {third, -third, third};
    const point axis = direction(plus(parent, straight));
    point rotated = times(-REAL(1.0), bone);
    add_multiple(&rotated, 2 * dot(axis, bone), axis);
    return rotated;
}

/* The cell of a number from -1 to 1: 0 to 15. */
static int cell_index(real a)
{
    int cell = 0;
    for (real edge = -REAL(0.875); cell < EDML_MAP_CELLS - 1 && a >= edge; edge += REAL(0.125)) cell++;
    return cell;
}

/* The cell on the octahedral map: the sphere, pushed onto an octahedron whose back is folded outwards. */
static map_cell cell_of(point bone)
{
    const real sum = ABS(bone.x) + ABS(bone.y) + ABS(bone.z); /* 1 to 1.74 */
    const real x = DIV(bone.x, sum), y = DIV(bone.y, sum);
    const real beside_x = REAL(1.0) - ABS(y), beside_y = REAL(1.0) - ABS(x);
    const int back = bone.z < 0;
    const map_cell cell = {cell_index(!back   ? y
                                      : y < 0 ? -beside_y
                                              : beside_y),
                           cell_index(!back   ? x
                                      : x < 0 ? -beside_x
                                              : beside_x)};
    return cell;
}

/* bone: in the torso's axes; parent: NULL for a bone that hangs on the torso itself. */
static int is_human(int kind, point bone, const point *parent)
{
    static const uint8_t first[] = {EDML_ARM_MAPS, EDML_FOREARM_MAPS, EDML_HEAD_MAPS, EDML_THIGH_MAPS,
                                    EDML_SHIN_MAPS};
    int map = first[kind];
    if (has_no_direction(bone)) return 0;
    if (parent != NULL) {
        if (has_no_direction(*parent)) return 0;
        const map_cell parent_cell = cell_of(*parent);
        map += parent_cell.row / 2 * EDML_MAP_PARENTS + parent_cell.column / 2;
        bone = unbent(bone, *parent);
    }
    const map_cell cell = cell_of(bone);
    return edml__joint_limit_maps[map][cell.row] >> cell.column & 1;
}

static int count_violations(const point x[EDML_JOINTS])
{
    const torso_axes chest = torso_axes_of(x, EDML_R_SHOULDER, EDML_L_SHOULDER);
    const torso_axes pelvis = torso_axes_of(x, EDML_R_HIP, EDML_L_HIP);
    point bone[OUTER_BONES];
    int violations = 0;
    for (int n = 0; n < OUTER_BONES; n++) {
        const int kind = outer_bones[n].kind;
        const point points = direction(minus(x[outer_bones[n].to], x[outer_bones[n].from]));
        bone[n] = in_axes(kind < THIGHS ? chest : pelvis, points, n);
        violations += !is_human(kind, bone[n], kind == FOREARMS || kind == SHINS ? &bone[n - 2] : NULL);
    }
    return violations;
}

static int count_pose_violations(const edml_pose *pose, int reflected)
{
    point x[EDML_JOINTS];
    for (int j = 0; j < EDML_JOINTS; j++) {
        x[j] = pose_joint(pose, j);
        if (reflected) x[j].z = -x[j].z;
    }
    return count_violations(x);
}

edml_status edml_joint_limits(int *violations, const edml_pose *pose)
{
    if (violations == NULL || pose == NULL) return EDML_ERR_ARGUMENT;
    if (!is_pose(pose)) return EDML_ERR_NOT_FINITE;
    *violations = count_pose_violations(pose, 0);
    return EDML_OK;
}

edml_status edml_reflect_by_joint_limits(int *fewer, edml_pose *pose)
{
    if (fewer == NULL || pose == NULL) return EDML_ERR_ARGUMENT;
    if (!is_pose(pose)) return EDML_ERR_NOT_FINITE;
    const int gain = count_pose_violations(pose, 0) - count_pose_violations(pose, 1);
    *fewer = gain > 0 ? gain : -gain;
    if (gain <= 0) return EDML_OK;
    for (int j = 0; j < EDML_JOINTS; j++) pose->joint[j].z = -pose->joint[j].z;
    return EDML_OK;
}

#endif
