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

#include "scene.h"

#define MAX_DISTANCE REAL(100.0) /* metres */
#define RIDGE REAL(0.01)         /* flat points stay solvable */

enum { MAX_STEPS = 24, MAX_EXTRAPOLATIONS = 8, MAX_REFINEMENTS = 5 };
/* Angles of Gauss-Newton steps, radians, after which no other is needed: the next would be far smaller. */
#define NEAR_ANGLE REAL(0.0078125)     /* 2^-7: near enough for refine_reprojection() */
#define FINAL_ANGLE REAL(0.0009765625) /* 2^-10 */

#define MAX_MISS REAL(2.0)              /* a joint is off by no more, in units of spread */
#define MIN_DEPTH REAL(0.3333333333333) /* of the person's depth: no joint is nearer */

typedef struct {
    matrix3 rotation;
    point translation; /* depth times spread */
    wide error;
} estimate;

/* ---- Residuals ---------------------------------------------------------------------------------- */

static point stretch(const scene *v, point p)
{
    const point q = {p.x, p.y, MUL(v->spread, p.z)};
    return q;
}

static point joint_at(const scene *v, const estimate *s, int j)
{
    return plus(stretch(v, rotate(&s->rotation, v->joint[j])), s->translation);
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
    out->miss_a = dot(out->a, at);
    out->miss_b = dot(out->b, at);
    return s->translation.z > 0;
}

/* In the camera's frame, times spread. */
static point in_camera(const scene *v, point at)
{
    const point flat = {MUL(v->spread, at.x), MUL(v->spread, at.y), at.z};
    return rotate_back(&v->view_rotation, flat);
}

/* In the image: distance from where the joint was seen, in units of spread, times the person's depth;
 * and its derivatives.  0 if the joint is too near or behind, or far from where it was seen. */
static int image_residual(joint_residual *out, const scene *v, const estimate *s, int j)
{
    const joint_residual none = {{0, 0, 0}, {0, 0, 0}, 0, 0};
    const real root = v->ray[j].z;
    const point p = in_camera(v, joint_at(v, s, j));
    *out = none;
    if (!(root > 0)) return 1;
    if (p.z < MUL(MIN_DEPTH, v->depth) || p.z <= EPSILON) return 0;
    if (ABS(p.x) / 8 > p.z || ABS(p.y) / 8 > p.z) return 0;
    const real x = DIV(p.x, p.z), y = DIV(p.y, p.z);
    if (HYPOT(x - v->ray[j].x, y - v->ray[j].y) > MUL(MAX_MISS, v->spread)) return 0;
    const real ratio = MUL(root, DIV(v->depth, p.z)); /* <= 3 */
    const matrix3 *r = &v->view_rotation;
    const point a = {r->x.x - MUL(x, r->x.z), r->y.x - MUL(x, r->y.z),
                     DIV(r->z.x - MUL(x, r->z.z), v->spread)};
    const point b = {r->x.y - MUL(y, r->x.z), r->y.y - MUL(y, r->y.z),
                     DIV(r->z.y - MUL(y, r->z.z), v->spread)};
    out->a = times(ratio, a);
    out->b = times(ratio, b);
    out->miss_a = MUL(MUL(root, v->depth), DIV(x - v->ray[j].x, v->spread));
    out->miss_b = MUL(MUL(root, v->depth), DIV(y - v->ray[j].y, v->spread));
    return 1;
}

/* Returns 0 if there is no error, as for a person behind the camera. */
static int sum_errors(estimate *s, const scene *v, residual_of *residual_at)
{
    s->error = 0;
    for (int j = 0; j < EDML_JOINTS; j++) {
        joint_residual of;
        if (!residual_at(&of, v, s, j)) return 0;
        s->error += PRODUCT(of.miss_a, of.miss_a) + PRODUCT(of.miss_b, of.miss_b);
    }
    return 1;
}

/* The best translation for a given rotation, and the error in space. */
static int best_translation(estimate *s, const scene *v)
{
    point pull = {0, 0, 0};
    for (int j = 0; j < EDML_JOINTS; j++) {
        const point at = stretch(v, rotate(&s->rotation, v->joint[j]));
        pull = minus(pull, times(dot(v->a[j], at), v->a[j]));
        pull = minus(pull, times(dot(v->b[j], at), v->b[j]));
    }
    return solve3(&s->translation, &v->lines, pull) && sum_errors(s, v, line_residual);
}

/* ---- Steps -------------------------------------------------------------------------------------- */

/* The Gauss-Newton step from an estimate, and about its angle, radians; 0 if there is none. */
static int gauss_newton_step(estimate *next, real *angle, const scene *v, const estimate *s,
                             residual_of *residual_at)
{
    const point zero = {0, 0, 0};
    equations n = {zero_matrix, zero_matrix, zero_matrix, zero, zero};
    for (int j = 0; j < EDML_JOINTS; j++) {
        joint_residual of;
        if (!residual_at(&of, v, s, j)) return 0;
        const point arm = rotate(&s->rotation, v->joint[j]);
        add_miss(&n, of.a, cross(arm, stretch(v, of.a)), of.miss_a);
        add_miss(&n, of.b, cross(arm, stretch(v, of.b)), of.miss_b);
    }
    point translation, camera;
    if (!solve_step(&translation, &camera, &n)) return 0;
    *angle = norm(camera);
    if (*angle > REAL(1.0)) return 0;
    const point half = {camera.x / 2, camera.y / 2, camera.z / 2};
    const matrix3 rotation = quaternion_rotation(REAL(1.0), half);
    next->rotation = compose_rotations(&rotation, &s->rotation);
    next->translation = plus(s->translation, translation);
    return 1;
}

/* The step of orthogonal iteration.  Because the joints' weighted mean is 0, sum q p' is R times their
 * scatter, less what the joints miss their lines by. */
static int orthogonal_iteration_step(estimate *next, const scene *v, const estimate *s)
{
    const point zero = {0, 0, 0};
    matrix3 m = {rotate(&v->scatter, s->rotation.x), rotate(&v->scatter, s->rotation.y),
                 rotate(&v->scatter, s->rotation.z)};
    for (int j = 0; j < EDML_JOINTS; j++) {
        joint_residual of;
        (void)line_residual(&of, v, s, j);
        const point miss = stretch(v, plus(times(of.miss_a, of.a), times(of.miss_b, of.b)));
        add_product(&m, minus(zero, miss), v->joint[j]);
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

/* Descends in space from a rotation; returns the number of steps, or -1 if there is no error there. */
static int object_space_descent(estimate *s, const scene *v)
{
    if (!best_translation(s, v)) return -1;
    int steps = 0, converged = 0;
    while (steps < MAX_STEPS && !converged) {
        estimate next;
        real angle = 0;
        const int stepped = gauss_newton_step(&next, &angle, v, s, line_residual);
        converged = stepped && angle < NEAR_ANGLE;
        int lower = stepped && best_translation(&next, v) && next.error < s->error;
        if (!lower && !converged) {
            lower = orthogonal_iteration_step(&next, v, s);
            if (lower) extrapolate(&next, v, s);
        }
        if (!lower) break;
        *s = next;
        steps++;
    }
    return steps;
}

/* The same on the error in the image. */
static int refine_reprojection(estimate *s, const scene *v)
{
    if (!sum_errors(s, v, image_residual)) return -1;
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
    m.z = cross(m.x, m.y);
    const real length = norm(m.z);
    if (!(length > MUL(RIDGE, MUL(norm(m.x), norm(m.y))) + EPSILON)) return 0;
    m.z = over(m.z, SQRT(length)); /* rows are 1 / (2 root of RIDGE) = 5 long at most, and m.z 25 */
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
    const real wide_x = DIV(camera->fx, f), wide_y = DIV(camera->fy, f); /* <= 1 */
    real root = 0;
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (!(v->ray[j].z > 0)) continue;
        const point p = in_camera(v, joint_at(v, s, j));
        const real x = MUL(wide_x, DIV(p.x, p.z) - v->ray[j].x);
        const real y = MUL(wide_y, DIV(p.y, p.z) - v->ray[j].y);
        root = HYPOT(root, MUL(v->ray[j].z, HYPOT(x, y)));
    }
    return MUL(f, root);
}

static edml_status write_placement(edml_placement *out, const scene *v, const estimate *s,
                                   const edml_pose *pose, const edml_camera *camera, int steps)
{
    const real far = MUL(s->translation.z, v->size);
    if (far / 128 >= MUL(MAX_DISTANCE / 128, v->spread)) return EDML_ERR_CAMERA;
    const point translation = {MUL(s->translation.x, v->size), MUL(s->translation.y, v->size),
                               DIV(far, v->spread)};
    const matrix3 back = transpose(&v->view_rotation), rotation = compose_rotations(&back, &s->rotation);
    const point origin = minus(rotate_back(&v->view_rotation, translation), rotate(&rotation, v->mean));
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
    if (!orthographic_start(s, v)) return EDML_ERR_DEGENERATE;
    estimate reversed;
    const int first = object_space_descent(s, v);
    const int second = reversed_start(&reversed, v, s) ? object_space_descent(&reversed, v) : -1;
    if (first < 0 && second < 0) return EDML_ERR_CAMERA;
    if (first < 0 || (second >= 0 && reversed.error < s->error)) *s = reversed;
    v->depth = in_camera(v, s->translation).z;
    const int third = refine_reprojection(s, v);
    if (third < 0) return EDML_ERR_CAMERA;
    *steps = (first > 0 ? first : 0) + (second > 0 ? second : 0) + third;
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
    v.joint = work->scratch.step[0];
    v.ray = work->scratch.step[1];
    v.a = work->scratch.step[2];
    v.b = work->scratch.step[3];
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
