/* The scene that a camera sees: joints, lines of sight, and the frame in which both have numbers of about 1.
 *
 * The view is the frame of a camera at the same place that looks at the person.  Depths in it are multiplied
 * by `spread`, the tangent of the person's half angle: so all numbers are about 1, near or far, and the
 * orthographic camera is the limit of spread 0.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_SCENE_H
#define EDML_SCENE_H

#include "../../api/pose.h"
#include "../../geometry/rotation.h"
#include "../../geometry/seen.h"
#include "least_squares.h"
#include "line_of_sight.h"

#define MIN_JOINTS 7                 /* from 6, one in some thousand finds another pose */
#define NEGLIGIBLE_PART 1024         /* a joint with less of all confidence counts as not seen */
#define MIN_SPREAD REAL(0.001953125) /* 2^-9 */
#define MIN_SIZE REAL(0.015625)      /* root of a pose's mean square, metres */

typedef struct {
    point *joint; /* [14] about their mean, in units of `size`: weighted squares add up to 1 */
    point *ray;   /* [14] x, y: where it was seen, at depth 1; z: root of its weight, 0 if not seen */
    point *a, *b; /* [14] two directions across the line of sight, with the weight's root */
    point mean;
    real size; /* metres */
    matrix3 view_rotation;
    matrix3 scatter;    /* joints times joints */
    matrix3 lines;      /* a times a and b times b */
    point across, down; /* joints times image */
    real spread;
    real depth; /* of the person, along the camera's axis, times spread: before refine_reprojection() */
} scene;

/* Sets the roots of the weights, which add up to 1. */
static edml_status set_weights(scene *v, const edml_keypoint in[EDML_JOINTS])
{
    uint16_t seen = seen_joints(in);
    if (!are_finite(in, seen)) return EDML_ERR_NOT_FINITE;
    pixels total = 0;
    for (int j = 0; j < EDML_JOINTS; j++)
        if (is_seen(seen, j)) total += in[j].c;
    if (!IS_FINITE(total)) return EDML_ERR_NOT_FINITE;
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (is_seen(seen, j) && in[j].c <= total / NEGLIGIBLE_PART) seen = (uint16_t)(seen & ~(1U << j));
        v->ray[j].z = is_seen(seen, j) ? SQRT(DIV_TO(REAL(1.0), in[j].c, total)) : 0; /* one of its parts */
    }
    return count_seen(seen) < MIN_JOINTS ? EDML_ERR_TOO_FEW_JOINTS : EDML_OK;
}

static edml_status set_rays(scene *v, const edml_keypoint in[EDML_JOINTS], const edml_camera *camera)
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (!(v->ray[j].z > 0)) continue;
        point ray;
        if (!line_of_sight(&ray, in[j], camera)) return EDML_ERR_CAMERA;
        v->ray[j].x = ray.x;
        v->ray[j].y = ray.y;
    }
    return EDML_OK;
}

static real weight_of(const scene *v, int j) { return SQUARE(v->ray[j].z); }

/* A joint in units of the size: its square, times its weight of over 1 / 1024, is at most that of the size. */
static point joint_over(point p, real size)
{
    /* root of 1024, and rounding */
    const point q = {DIV_TO(REAL(33.0), p.x, size), DIV_TO(REAL(33.0), p.y, size),
                     DIV_TO(REAL(33.0), p.z, size)};
    return q;
}

/* Centres the joints on their mean and scales them; joints that were not seen stay at 0. */
static edml_status centre_joints(scene *v, const edml_pose *pose)
{
    const point zero = {0, 0, 0};
    point sum = zero;
    real total = 0;
    for (int j = 0; j < EDML_JOINTS; j++) {
        add_multiple(&sum, weight_of(v, j), pose_joint(pose, j));
        total += weight_of(v, j);
    }
    ASSUME(REAL(0.98) <= total && total <= REAL(1.01)); /* but for rounding, and for what is negligible */
    v->mean = over(sum, total);
    ASSUME(ALL_WITHIN(v->mean, POSE_REACH)); /* as the joints are */
    real squares = 0;
    for (int j = 0; j < EDML_JOINTS; j++) {
        const point p = minus(pose_joint(pose, j), v->mean);
        const point weighted = times(v->ray[j].z, p); /* squares add up to 48 m^2 at most */
        ASSUME(ALL_WITHIN(weighted, REAL(4.01))); /* the square is w (1 - w) of 8^2 at most */
        v->joint[j] = v->ray[j].z > 0 ? p : zero;
        squares += dot(weighted, weighted);
        ASSUME(0 <= squares && squares <= REAL(48.5)); /* as those of 4 m along three axes */
    }
    v->size = SQRT(squares);
    if (v->size < MIN_SIZE) return EDML_ERR_DEGENERATE;
    v->scatter = zero_matrix;
    for (int j = 0; j < EDML_JOINTS; j++) {
        v->joint[j] = joint_over(v->joint[j], v->size);
        const point p = times(v->ray[j].z, v->joint[j]);
        ASSUME(ALL_WITHIN(p, REAL(1.01))); /* their squares add up to 1 */
        add_product(&v->scatter, p, p);
    }
    return EDML_OK;
}

/* The smallest rotation that brings the axis of the view to the mean ray. */
static void set_view_rotation(scene *v)
{
    point sum = {0, 0, 0};
    for (int j = 0; j < EDML_JOINTS; j++) {
        const point ray = {v->ray[j].x, v->ray[j].y, REAL(1.0)};
        if (v->ray[j].z > 0) add_multiple(&sum, weight_of(v, j), ray);
    }
    ASSUME(sum.z >= REAL(0.98)); /* the weights add up to 1 */
    v->view_rotation = rotation_onto(over_length(sum, norm(sum))); /* z.z > 1/3: no ray is steeper than 2 */
}

/* Where the rays pass depth 1 of the view, to a; and `spread`, their RMS. */
static edml_status measure_spread(scene *v)
{
    real squares = 0;
    for (int j = 0; j < EDML_JOINTS; j++) {
        const point ray = {v->ray[j].x, v->ray[j].y, REAL(1.0)}, zero = {0, 0, 0};
        v->a[j] = zero;
        if (!(v->ray[j].z > 0)) continue;
        const point seen = rotate(&v->view_rotation, ray);
        if (2 * seen.z < norm(ray)) return EDML_ERR_CAMERA; /* 60 degrees off: tangents to 1.8 */
        ASSUME(seen.z >= REAL(0.49)); /* half of a norm of 1 or more */
        v->a[j].x = DIV(seen.x, seen.z);
        v->a[j].y = DIV(seen.y, seen.z);
        /* the tangent of 60 degrees */
        ASSUME(WITHIN(v->a[j].x, REAL(1.8)) && WITHIN(v->a[j].y, REAL(1.8)));
        const point weighted = times(v->ray[j].z, v->a[j]);
        squares += dot(weighted, weighted);
        ASSUME(0 <= squares && squares <= REAL(3.2)); /* a mean of squares up to that of 1.8 */
    }
    v->spread = SQRT(squares);
    return v->spread < MIN_SPREAD ? EDML_ERR_DEGENERATE : EDML_OK;
}

/* Unit vectors across each line of sight, (u, v, 1) in the view: b = (0, 1, -v) / |...| and
 * a = b x (u, v, 1) / |...|, with depth divided by `spread`, times the weight's root. */
static void set_lines(scene *v)
{
    const point zero = {0, 0, 0};
    v->across = zero;
    v->down = zero;
    v->lines = zero_matrix;
    for (int j = 0; j < EDML_JOINTS; j++) {
        const real x = v->a[j].x, y = v->a[j].y, root = v->ray[j].z;
        /* as joints in units of their size: weighted, their squares add up to 1 */
        const real wide_x = DIV_TO(REAL(33.0), x, v->spread), wide_y = DIV_TO(REAL(33.0), y, v->spread);
        const point weighted = times(root, v->joint[j]);
        ASSUME(ALL_WITHIN(weighted, REAL(1.01))); /* as are these */
        add_multiple(&v->across, MUL_TO(REAL(1.01), root, wide_x), weighted);
        add_multiple(&v->down, MUL_TO(REAL(1.01), root, wide_y), weighted);

        const real height = HYPOT(REAL(1.0), y);
        const real root_b = DIV(root, height), root_a = DIV(root_b, HYPOT(height, x));
        /* root_b and root_a are below root */
        const point b = {0, root_b, -MUL_TO(REAL(1.01), root_b, wide_y)};
        const point a = {MUL(root_a, REAL(1.0) + SQUARE(y)), -MUL(root_a, MUL(x, y)),
                         -MUL_TO(REAL(1.01), root_a, wide_x)};
        ASSUME(ALL_WITHIN(a, REAL(1.01))); /* but for z, a part of a unit vector */
        v->a[j] = a;
        v->b[j] = b;
        add_product(&v->lines, a, a);
        add_product(&v->lines, b, b);
    }
}

static edml_status set_up_scene(scene *v, const edml_pose *pose, const edml_keypoint in[EDML_JOINTS],
                                const edml_camera *camera)
{
    if (!is_camera(camera)) return EDML_ERR_CAMERA;
    if (!is_pose(pose)) return EDML_ERR_NOT_FINITE;
    edml_status status = set_weights(v, in);
    if (status == EDML_OK) status = set_rays(v, in, camera);
    if (status == EDML_OK) status = centre_joints(v, pose);
    if (status != EDML_OK) return status;
    set_view_rotation(v);
    status = measure_spread(v);
    if (status == EDML_OK) set_lines(v);
    return status;
}

#endif
