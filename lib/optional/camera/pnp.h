/* Places a pose before the camera, so that its joints are seen where they were, by orthogonal iteration (Lu,
 * Hager, Mjolsness, "Fast and globally convergent pose estimation from video images", 2000).
 *
 * A joint p was seen along a line through the camera's centre; R p + t should lie on it.  The iteration
 * lowers the object-space error: the sum of the squared distances from the lines.  For given R the best t is
 * linear; for given R and t the nearest points of the lines are what R should rotate the joints onto, a
 * problem of absolute orientation.  Alternating, the error never rises, but it takes tens of steps, and
 * sometimes hundreds.  So each step is a Gauss-Newton step where that lowers the error, and an alternation
 * where it does not.  A person is nearly flat, and looks nearly the same with depths reversed: both are tried.
 * A few steps on the error in the image follow.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_PNP_H
#define EDML_PNP_H

#include <string.h>

#include "horn.h"
#include "scene.h"

#define MAX_DISTANCE REAL(100.0) /* metres */
#define RIDGE REAL(0.01)         /* flat points stay solvable */

enum { MAX_STEPS = 24, MAX_EXTRAPOLATIONS = 8, MAX_REFINEMENTS = 5 };
/* Angles of Gauss-Newton steps, radians, after which no other is needed: the next would be far smaller. */
#define NEAR_ANGLE REAL(0.0078125)     /* 2^-7: near enough for refine_reprojection() */
#define FINAL_ANGLE REAL(0.0009765625) /* 2^-10 */

#define MAX_MISS REAL(2.0)              /* a joint is off by no more, in units of spread */
#define MAX_IMAGE REAL(7.0)             /* tangents: 3 of a ray, and MAX_MISS spreads of 1.8 */
#define MIN_DEPTH REAL(0.3333333333333) /* of the person's depth: no joint is nearer */
#define MAX_IN_CAMERA REAL(20.0)        /* a joint is no farther, in units of the size, depth times spread */

typedef struct {
    matrix3 rotation;
    point translation; /* depth times spread */
    wide error;
} estimate;

/* ---- Residuals ---------------------------------------------------------------------------------- */

/* dot() and cross() of what may be long: clamped to 64. */
static real clamped_dot(point a, point b)
{
    return SATURATE(PRODUCT(a.x, b.x) + PRODUCT(a.y, b.y) + PRODUCT(a.z, b.z));
}

static point clamped_cross(point a, point b)
{
    const point product = {SATURATE(PRODUCT(a.y, b.z) - PRODUCT(a.z, b.y)),
                           SATURATE(PRODUCT(a.z, b.x) - PRODUCT(a.x, b.z)),
                           SATURATE(PRODUCT(a.x, b.y) - PRODUCT(a.y, b.x))};
    return product;
}

static point stretch(const scene *v, point p)
{
    const point q = {p.x, p.y, SATURATE(PRODUCT(v->spread, p.z))};
    return q;
}

static point arm_of(const scene *v, const estimate *s, int j)
{
    const point arm = rotate(&s->rotation, v->joint[j]);
    ASSUME(ALL_WITHIN(arm, REAL(33.1))); /* as long as the joint: joint_over() */
    return arm;
}

static point joint_at(const scene *v, const estimate *s, int j)
{
    return plus(stretch(v, arm_of(v, s, j)), s->translation);
}

/* What joint j misses along two directions, and the derivatives, which are these. */
typedef struct {
    point a, b;
    real miss_a, miss_b;
} joint_residual;

typedef int residual_of(joint_residual *out, const scene *v, const estimate *s, int j);

/* In space: the distance from the line of sight. */
static int line_residual(joint_residual *out, const scene *v, const estimate *s, int j)
{
    const point at = joint_at(v, s, j);
    out->a = v->a[j];
    out->b = v->b[j];
    out->miss_a = clamped_dot(out->a, at);
    out->miss_b = clamped_dot(out->b, at);
    return s->translation.z > 0;
}

/* In the camera's frame, times spread: rotate_back() of what may be long. */
static point in_camera(const scene *v, point at)
{
    const point flat = {MUL(v->spread, at.x), MUL(v->spread, at.y), at.z};
    const matrix3 back = transpose(&v->view_rotation);
    const point p = {clamped_dot(back.x, flat), clamped_dot(back.y, flat), clamped_dot(back.z, flat)};
    return p;
}

static real over_spread(const scene *v, real a) /* clamped to 32 */
{
    const real most = MUL(REAL(32.0), v->spread);
    return DIV_TO(REAL(32.1), a > most ? most : a < -most ? -most : a, v->spread); /* as it was compared */
}

/* In the image: distance from where the joint was seen, in units of spread, times the person's depth;
 * and its derivatives.  0 if the joint is too near or behind, or far from where it was seen. */
static int image_residual(joint_residual *out, const scene *v, const estimate *s, int j)
{
    const joint_residual none = {{0, 0, 0}, {0, 0, 0}, 0, 0};
    const real root = v->ray[j].z;
    *out = none;
    if (!(root > 0)) return 1;
    const point p = in_camera(v, joint_at(v, s, j));
    if (p.z < MUL(MIN_DEPTH, v->depth) || p.z <= EPSILON || !ALL_WITHIN(p, MAX_IN_CAMERA)) return 0;
    const real off_x = p.x - MUL(v->ray[j].x, p.z), off_y = p.y - MUL(v->ray[j].y, p.z);
    if (HYPOT(off_x, off_y) > MUL(MUL(MAX_MISS, v->spread), p.z)) return 0;
    const real x = DIV_TO(MAX_IMAGE, p.x, p.z), y = DIV_TO(MAX_IMAGE, p.y, p.z); /* as they were compared */
    const real ratio = MUL(root, DIV_TO(REAL(3.2), v->depth, p.z)); /* no nearer than MIN_DEPTH */
    const matrix3 *r = &v->view_rotation;
    const point a = {r->x.x - MUL(x, r->x.z), r->y.x - MUL(x, r->y.z),
                     over_spread(v, r->z.x - MUL(x, r->z.z))};
    const point b = {r->x.y - MUL(y, r->x.z), r->y.y - MUL(y, r->y.z),
                     over_spread(v, r->z.y - MUL(y, r->z.z))};
    out->a = times(ratio, a);
    out->b = times(ratio, b);
    /* as it was compared with MAX_MISS */
    out->miss_a = MUL(MUL(root, v->depth), DIV_TO(REAL(2.1), x - v->ray[j].x, v->spread));
    out->miss_b = MUL(MUL(root, v->depth), DIV_TO(REAL(2.1), y - v->ray[j].y, v->spread));
    return 1;
}

/* Returns 0 if there is no error, as for a person behind the camera. */
static int sum_errors(estimate *s, const scene *v, residual_of *residual_at)
{
    wide sum = 0;
    for (int j = 0; j < EDML_JOINTS; j++) {
        joint_residual of;
        if (!residual_at(&of, v, s, j)) return 0;
        sum += PRODUCT(of.miss_a, of.miss_a) + PRODUCT(of.miss_b, of.miss_b);
    }
    s->error = sum;
    return 1;
}

/* The best translation for a given rotation, and the error in space. */
static int best_translation(estimate *s, const scene *v)
{
    point pull = {0, 0, 0};
    for (int j = 0; j < EDML_JOINTS; j++) {
        const point at = stretch(v, arm_of(v, s, j));
        const real a = dot(v->a[j], at), b = dot(v->b[j], at);
        ASSUME(WITHIN(a, REAL(1.01)) && WITHIN(b, REAL(1.01))); /* as joints with their weights */
        pull = minus(pull, times(a, v->a[j]));
        pull = minus(pull, times(b, v->b[j]));
    }
    return solve3(&s->translation, &v->lines, pull) && sum_errors(s, v, line_residual);
}

/* ---- Steps -------------------------------------------------------------------------------------- */

/* The Gauss-Newton step from an estimate, and about its angle, radians; 0 if there is none. */
static int gauss_newton_step(estimate *next, real *angle, const scene *v, const estimate *s,
                             residual_of *residual_at)
{
    equations n;
    memset(&n, 0, sizeof n);
    for (int j = 0; j < EDML_JOINTS; j++) {
        joint_residual of;
        if (!residual_at(&of, v, s, j)) return 0;
        const point arm = arm_of(v, s, j);
        add_miss(&n, of.a, clamped_cross(arm, stretch(v, of.a)), of.miss_a);
        add_miss(&n, of.b, clamped_cross(arm, stretch(v, of.b)), of.miss_b);
    }
    point translation, camera;
    if (!solve_step(&translation, &camera, &n)) return 0;
    *angle = norm(camera);
    if (*angle > REAL(1.0)) return 0;
    ASSUME(ALL_WITHIN(camera, REAL(1.01))); /* no component is longer than the vector */
    next->translation = plus(s->translation, translation);
    if (!ALL_WITHIN(next->translation, MAX_SOLUTION)) return 0;
    const point half = {camera.x / 2, camera.y / 2, camera.z / 2};
    const matrix3 rotation = quaternion_rotation(REAL(1.0), half);
    next->rotation = compose_rotations(&rotation, &s->rotation);
    return 1;
}

/* A joint by a component of what it misses its line by; both have the root of its weight as a factor in all. */
static point weighted_joint(real miss, point joint)
{
    /* weighted, joints and misses are within 1 */
    const point p = {MUL_TO(REAL(1.5), miss, joint.x), MUL_TO(REAL(1.5), miss, joint.y),
                     MUL_TO(REAL(1.5), miss, joint.z)};
    return p;
}

/* The step of orthogonal iteration.  Because the joints' weighted mean is 0, sum q p' is R times their
 * scatter, less what the joints miss their lines by. */
static int orthogonal_iteration_step(estimate *next, const scene *v, const estimate *s)
{
    matrix3 m = {rotate(&v->scatter, s->rotation.x), rotate(&v->scatter, s->rotation.y),
                 rotate(&v->scatter, s->rotation.z)};
    for (int j = 0; j < EDML_JOINTS; j++) {
        joint_residual of;
        (void)line_residual(&of, v, s, j);
        /* those of the best translation: squared they add up to no more than the joints' */
        ASSUME(WITHIN(of.miss_a, REAL(1.01)) && WITHIN(of.miss_b, REAL(1.01)));
        const point miss = stretch(v, plus(times(of.miss_a, of.a), times(of.miss_b, of.b)));
        m.x = minus(m.x, weighted_joint(miss.x, v->joint[j]));
        m.y = minus(m.y, weighted_joint(miss.y, v->joint[j]));
        m.z = minus(m.z, weighted_joint(miss.z, v->joint[j]));
    }
    if (!nearest_rotation(&next->rotation, &m) || !best_translation(next, v)) return 0;
    return next->error < s->error;
}

/* Where steps are short, many more would point the same way: doubles the step while that lowers the
 * error. */
static void extrapolate(estimate *next, const scene *v, const estimate *s)
{
    const matrix3 back = transpose(&s->rotation);
    matrix3 step = compose_rotations(&next->rotation, &back);
    for (int n = 0; n < MAX_EXTRAPOLATIONS; n++) {
        estimate far;
        far.rotation = compose_rotations(&step, &next->rotation);
        if (!best_translation(&far, v) || !(far.error < next->error)) return;
        *next = far;
        step = compose_rotations(&step, &step);
    }
}

/* Descends in space from a rotation; returns the number of steps.  If there is no error there, s->error stays. */
static int object_space_descent(estimate *s, const scene *v)
{
    if (!best_translation(s, v)) return 0;
    int steps = 0, converged = 0;
    while (steps < MAX_STEPS && !converged) {
        estimate next;
        real angle;
        const int stepped = gauss_newton_step(&next, &angle, v, s, line_residual);
        converged = stepped && angle < NEAR_ANGLE;
        if (!stepped || !best_translation(&next, v) || !(next.error < s->error)) {
            if (converged || !orthogonal_iteration_step(&next, v, s)) break;
            extrapolate(&next, v, s);
        }
        *s = next;
        steps++;
    }
    return steps;
}

/* The same on the error in the image. */
static int refine_reprojection(estimate *s, const scene *v)
{
    if (!(v->depth > 0) || !sum_errors(s, v, image_residual)) return -1;
    int steps = 0, converged = 0;
    while (steps < MAX_REFINEMENTS && !converged) {
        estimate next;
        real angle;
        if (!gauss_newton_step(&next, &angle, v, s, image_residual)) break;
        if (!sum_errors(&next, v, image_residual) || !(next.error < s->error)) break;
        converged = angle < FINAL_ANGLE;
        *s = next;
        steps++;
    }
    return steps;
}

/* ---- Starts ------------------------------------------------------------------------------------- */

/* The scaled-orthographic solution: two rows that map joints to the image best in the least squares, a
 * third across them, and the rotation nearest to the three. */
static int orthographic_start(estimate *s, const scene *v)
{
    matrix3 scatter = v->scatter, m;
    scatter.x.x += RIDGE;
    scatter.y.y += RIDGE;
    scatter.z.z += RIDGE;
    if (!solve3(&m.x, &scatter, v->across) || !solve3(&m.y, &scatter, v->down)) return 0;
    ASSUME(ALL_WITHIN(m.x, REAL(5.1)) && ALL_WITHIN(m.y, REAL(5.1))); /* 1 / (2 root of RIDGE) long at most */
    m.z = cross(m.x, m.y);
    const real length = norm(m.z);
    if (!(length > MUL(RIDGE, MUL(norm(m.x), norm(m.y))) + EPSILON)) return 0;
    m.z = over(m.z, SQRT(length)); /* 5 long at most */
    return nearest_rotation(&s->rotation, &m);
}

/* The rotation nearest to an estimate's with its depths reversed. */
static int reversed_start(estimate *reversed, const scene *v, const estimate *s)
{
    const point away = rotate(&v->scatter, s->rotation.z);
    const matrix3 m = {rotate(&v->scatter, s->rotation.x),
                       rotate(&v->scatter, s->rotation.y),
                       {-away.x, -away.y, -away.z}};
    return nearest_rotation(&reversed->rotation, &m);
}

/* ---- The result --------------------------------------------------------------------------------- */

/* Root of the weighted mean of the squared distances in the image, pixels.  They are added in units of the
 * larger focal length, so that squares fit whatever a pixel is. */
static pixels reprojection_of(const scene *v, const estimate *s, const edml_camera *camera)
{
    const pixels f = camera->fx > camera->fy ? camera->fx : camera->fy;
    /* f is the larger one */
    const real wide_x = DIV_TO(REAL(1.0), camera->fx, f), wide_y = DIV_TO(REAL(1.0), camera->fy, f);
    real root = 0;
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (!(v->ray[j].z > 0)) continue;
        const point p = in_camera(v, joint_at(v, s, j));
        /* image_residual() has seen it */
        const real x = MUL(wide_x, DIV_TO(MAX_IMAGE, p.x, p.z) - v->ray[j].x);
        const real y = MUL(wide_y, DIV_TO(MAX_IMAGE, p.y, p.z) - v->ray[j].y);
        root = HYPOT(root, MUL(v->ray[j].z, HYPOT(x, y)));
    }
    ASSUME(root <= REAL(3.65)); /* no joint is off by more than MAX_MISS spreads of 1.8 */
    return MUL(f, root);
}

/* dot() of what is up to MAX_DISTANCE; returns 0 beyond that. */
static int far_dot(real *product, point a, point b)
{
    const wide sum = EXACT(a.x, b.x) + EXACT(a.y, b.y) + EXACT(a.z, b.z);
    if (!WITHIN(sum, EXACT(MAX_DISTANCE, REAL(1.0)))) return 0;
    *product = FROM_EXACT(sum);
    return 1;
}

/* In metres; 0 if that is too far away, or behind the camera. */
static int mean_in_camera(point *mean, const scene *v, const estimate *s)
{
    const matrix3 back = transpose(&v->view_rotation);
    const real far = MUL(s->translation.z, v->size);
    if (far < 0 || far / 128 >= MUL(MAX_DISTANCE / 128, v->spread)) return 0;
    /* as it was compared */
    const point p = {MUL(s->translation.x, v->size), MUL(s->translation.y, v->size),
                     DIV_TO(MAX_DISTANCE, far, v->spread)};
    if (!far_dot(&mean->x, back.x, p) || !far_dot(&mean->y, back.y, p) || !far_dot(&mean->z, back.z, p))
        return 0;
    return 1;
}

static edml_status write_placement(edml_placement *out, const scene *v, const estimate *s,
                                   const edml_pose *pose, const edml_camera *camera, int steps)
{
    const matrix3 back = transpose(&v->view_rotation), rotation = compose_rotations(&back, &s->rotation);
    point mean, origin;
    if (!mean_in_camera(&mean, v, s)) return EDML_ERR_CAMERA;
    origin = minus(mean, rotate(&rotation, v->mean));
    for (int j = 0; j < EDML_JOINTS; j++)
        if (dot(rotation.z, pose_joint(pose, j)) + origin.z <= 0) return EDML_ERR_CAMERA;
    for (int j = 0; j < EDML_JOINTS; j++)
        out->joint[j] = api_point(plus(rotate(&rotation, pose_joint(pose, j)), origin));
    out->rotation[0] = api_point(rotation.x);
    out->rotation[1] = api_point(rotation.y);
    out->rotation[2] = api_point(rotation.z);
    out->translation = api_point(origin);
    out->reprojection = reprojection_of(v, s, camera);
    out->steps = (uint16_t)steps;
    return EDML_OK;
}

/* Descends in space from two starts, takes the better one, and refines it in the image.  Counts the
 * steps. */
static edml_status find_estimate(estimate *s, int *steps, scene *v)
{
    estimate reversed = {zero_matrix, {0, 0, 0}, WIDE_MAX};
    *s = reversed; /* neither has an error yet */
    if (!orthographic_start(s, v)) return EDML_ERR_DEGENERATE;
    *steps = object_space_descent(s, v);
    if (reversed_start(&reversed, v, s)) *steps += object_space_descent(&reversed, v);
    if (reversed.error < s->error) *s = reversed;
    if (!(s->error < WIDE_MAX)) return EDML_ERR_CAMERA;
    v->depth = in_camera(v, s->translation).z;
    ASSUME(v->depth <= REAL(22.0)); /* root of (1.8 * 8)^2 + (1.8 * 8)^2 + 8^2: a rotation changes no length */
    const int more = refine_reprojection(s, v);
    if (more < 0) return EDML_ERR_CAMERA;
    *steps += more;
    return EDML_OK;
}

edml_status edml_place(edml_placement *out, const edml_pose *pose, const edml_keypoint in[EDML_JOINTS],
                       const edml_camera *camera, void *memory, size_t work_bytes)
{
    if (out == NULL || pose == NULL || in == NULL || camera == NULL || memory == NULL)
        return EDML_ERR_ARGUMENT;
    if (!EDML_IS_ALIGNED4(memory)) return EDML_ERR_ARGUMENT;
    if (work_bytes < sizeof(edml_work)) return EDML_ERR_WORK_TOO_SMALL;
    edml_work *const work = (edml_work *)memory; /* tests/overflow compiles this as C++ */
    scene v;
    v.joint = work->of.points.stage.step[0];
    v.ray = work->of.points.stage.step[1];
    v.a = work->of.points.stage.step[2];
    v.b = work->of.points.stage.step[3];
    edml_status status = set_up_scene(&v, pose, in, camera);
    if (status != EDML_OK) return status;
    estimate s;
    int steps = 0;
    status = find_estimate(&s, &steps, &v);
    if (status != EDML_OK) return status;
    return write_placement(out, &v, &s, pose, camera, steps);
}

/* ---- Unknown focal length ------------------------------------------------------------------------- */

/* Relative to the image's height: 0.5 to 4 in 11 equal steps of the logarithm. */
static const real sweep_factor[EDML_FOCAL_LENGTHS] = {
    REAL(0.5),      REAL(0.604045), REAL(0.72974),  REAL(0.881591), REAL(1.065041), REAL(1.286665),
    REAL(1.554406), REAL(1.877862), REAL(2.268625), REAL(2.740702), REAL(3.311013), REAL(4.0)};

static int is_image_size(pixels width, pixels height)
{
    return IS_FINITE(width) && IS_FINITE(height) && width > 0 && height > 0;
}

/* The camera that looks at the middle of the image; returns 0 if its focal length is out of range. */
static int centred_camera(edml_camera *camera, real factor, pixels width, pixels height)
{
    const pixels eighth = MUL(height, factor / 8);
    if (!IS_FINITE(4 * eighth)) return 0; /* nor would the whole be */
    const pixels f = 8 * eighth;
    const edml_camera centred = {f, f, width / 2, height / 2};
    *camera = centred;
    return 1;
}

edml_status edml_place_sweep(edml_placement *out, edml_camera *found, const edml_pose *pose,
                             const edml_keypoint in[EDML_JOINTS], pixels width, pixels height, void *memory,
                             size_t work_bytes)
{
    if (out == NULL || found == NULL || pose == NULL || in == NULL || memory == NULL)
        return EDML_ERR_ARGUMENT;
    if (!is_image_size(width, height)) return EDML_ERR_CAMERA;
    edml_status best = EDML_ERR_CAMERA;
    for (int n = 0; n < EDML_FOCAL_LENGTHS; n++) {
        edml_camera tried;
        edml_placement placed;
        if (!centred_camera(&tried, sweep_factor[n], width, height)) continue;
        const edml_status status = edml_place(&placed, pose, in, &tried, memory, work_bytes);
        if (status == EDML_OK && (best != EDML_OK || placed.reprojection < out->reprojection)) {
            *out = placed;
            *found = tried;
        }
        if (best != EDML_OK) best = status;
    }
    return best;
}

#endif
