/* From the axes of the MDS to those of the body's frame: scaled-orthographic alignment in closed form.
 *
 * Let M be the 2x3 matrix that maps the centred points to the image best in the least squares.
 * The first two rows of the rotation are the orthonormal pair nearest to M's rows,
 * (M M')^(-1/2) M; the third is their cross product.  M's scale does not matter.
 *
 * An error of the points, along their thinnest axis above all, would look like a tilt.  So this is ridge
 * regression: once with a light ridge, to see how far image and points disagree, and once with that as
 * the ridge.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_ORIENT_H
#define EDML_ORIENT_H

#include "../geometry/centre.h"

/* Ridges, relative to the points' spread. */
#define ORIENT_LIGHT_RIDGE REAL(0.001)
#define ORIENT_MIN_RIDGE REAL(0.0001) /* flat points stay solvable */

#define PARALLEL_SQUARED REAL(9.5367431640625e-7) /* 2^-20: squared sine that rounding can make */

/* Sums over the seen joints.  The points are those of the MDS, of any distances up to 3 m, or refined: their
 * squares about the mean add up to at most 105, and along any axis to 32 (lift/refine.h).  The image's
 * coordinates are halved: their squares add up to at most 47. */
typedef struct {
    real xx, xy, xz, yy, yz, zz; /* products of the points about their mean */
    point u, v;                  /* points times image: at most 75 */
    real image;                  /* squares of the image about its mean */
} moments;

static void add_moments(moments *m, point p, edml_image_point at)
{
    m->xx += SQUARE(p.x);
    m->xy += MUL(p.x, p.y);
    m->xz += MUL(p.x, p.z);
    m->yy += SQUARE(p.y);
    m->yz += MUL(p.y, p.z);
    m->zz += SQUARE(p.z);
    add_multiple(&m->u, at.u, p);
    add_multiple(&m->v, at.v, p);
    m->image += SQUARE(at.u) + SQUARE(at.v);
    /* roots of 32 * 32, and of 32 * 47 */
    ASSUME(WITHIN(m->xx, REAL(32.0)) && WITHIN(m->yy, REAL(32.0)) && WITHIN(m->zz, REAL(32.0)));
    ASSUME(WITHIN(m->xy, REAL(32.0)) && WITHIN(m->xz, REAL(32.0)) && WITHIN(m->yz, REAL(32.0)));
    ASSUME(ALL_WITHIN(m->u, REAL(39.0)) && ALL_WITHIN(m->v, REAL(39.0)));
}

static EDML_NOINLINE void sum_moments(moments *m, const point x[EDML_JOINTS], const edml_image *image)
{
    const moments none = {0, 0, 0, 0, 0, 0, {0, 0, 0}, {0, 0, 0}, 0};
    const point mean = mean_joint(x, image->seen);
    const real count = (real)count_seen(image->seen);
    real u = 0, v = 0;
    *m = none;
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (!is_seen(image->seen, j)) continue;
        const edml_image_point at = {image->at[j].u / 2, image->at[j].v / 2};
        ASSUME(WITHIN(at.v, REAL(0.51))); /* along the body's axis seen joints are within 1 */
        u += at.u;
        v += at.v;
        const point p = minus(x[j], mean);
        ASSUME(ALL_WITHIN(p, REAL(5.71))); /* root of 32, and rounding */
        add_moments(m, p, at);             /* the points are centred, so the image need not be */
    }
    m->image -= MUL(u / count, u) + MUL(v / count, v);
}

/* Scales the points so that xx + yy + zz = 4.  In u and v, scales points and image so that the squares of
 * either add up to 1; u and v are then at most 1 long.  Returns 0 if points or image are one point.
 * Rounding changes each sum by 7 steps at most.  Where points are nearly one, of 57 steps of spread 36 may be
 * left: u and v are then 1.26 long, and S is off by a matrix of norm 21 / 9 = 2.33. */
static EDML_NOINLINE int scale_moments(moments *m)
{
    const real spread = m->xx + m->yy + m->zz;
    const real lengths = MUL(SQRT(spread), SQRT(m->image)); /* <= 75 */
    const real part = spread / 4;
    if (!(part > EPSILON && lengths > EPSILON)) return 0;
    /* none is above the spread, which is 39 / 9 parts at most */
    m->xx = DIV_TO(REAL(4.4), m->xx, part);
    m->xy = DIV_TO(REAL(4.4), m->xy, part);
    m->xz = DIV_TO(REAL(4.4), m->xz, part);
    m->yy = DIV_TO(REAL(4.4), m->yy, part);
    m->yz = DIV_TO(REAL(4.4), m->yz, part);
    m->zz = DIV_TO(REAL(4.4), m->zz, part);
    m->u = over(m->u, lengths);
    m->v = over(m->v, lengths);
    ASSUME(ALL_WITHIN(m->u, REAL(1.3)) && ALL_WITHIN(m->v, REAL(1.3))); /* 1.26 long */
    return 1;
}

/* Solution of (S + ridge I) r = b up to a positive factor: the adjugate times b.  The eigenvalues of
 * S + ridge I are at most 8, their sum at most 16; the adjugate's are at most 36.  As b b' <= S / 4, b is
 * short where the adjugate is large: |r| <= 18, and 30 where S is off by 2.33. */
static point solve_scaled(const moments *s, real ridge, point b)
{
    const real xx = s->xx + 4 * ridge, yy = s->yy + 4 * ridge, zz = s->zz + 4 * ridge;
    const real xy = MUL(s->xz, s->yz) - MUL(s->xy, zz);
    const real xz = MUL(s->xy, s->yz) - MUL(s->xz, yy);
    const real yz = MUL(s->xy, s->xz) - MUL(xx, s->yz);
    /* (a + c)(b + c) + (a + b)(c + 4) of a diagonal a, b, c: no product is above the sum of two squares */
    ASSUME(WITHIN(xy, REAL(25.0)) && WITHIN(xz, REAL(25.0)) && WITHIN(yz, REAL(25.0)));
    /* of two entries on the diagonal that add up to 4.4 + 2 * 4 ridge at most */
    const point r = {MUL(MUL_TO(REAL(38.5), yy, zz) - SQUARE(s->yz), b.x) + MUL(xy, b.y) + MUL(xz, b.z),
                     MUL(xy, b.x) + MUL(MUL_TO(REAL(38.5), xx, zz) - SQUARE(s->xz), b.y) + MUL(yz, b.z),
                     MUL(xz, b.x) + MUL(yz, b.y) + MUL(MUL_TO(REAL(38.5), xx, yy) - SQUARE(s->xy), b.z)};
    ASSUME(ALL_WITHIN(r, REAL(40.0))); /* as above */
    return r;
}

/* r' S r, at most 4 for a unit vector. */
static real spread_along(const moments *s, point r)
{
    const point product = {MUL(s->xx, r.x) + MUL(s->xy, r.y) + MUL(s->xz, r.z),
                           MUL(s->xy, r.x) + MUL(s->yy, r.y) + MUL(s->yz, r.z),
                           MUL(s->xz, r.x) + MUL(s->yz, r.y) + MUL(s->zz, r.z)};
    return dot(r, product);
}

/* The squared residual between the image, at its best scale, and the points along two axes.  Relative to
 * the points' spread; at most 1. */
static EDML_NOINLINE real orient_residual(const moments *m, point right, point down)
{
    const real across = (spread_along(m, right) + spread_along(m, down)) / 4; /* <= 1 */
    const real fit = dot(right, m->u) + dot(down, m->v);                      /* <= sqrt(across) */
    ASSUME(WITHIN(across, REAL(2.0)) && WITHIN(fit, REAL(2.0))); /* where S is off, and u and v 1.26 long */
    const real square = SQUARE(fit);
    const real left = MUL(across, across - square);
    if (fit <= 0 || left >= square) return REAL(1.0);
    return left > 0 ? DIV_TO(REAL(1.0), left, square) : 0; /* left < square */
}

/* The nearest orthonormal pair, in place; 0 if there is none because the two are parallel.  Where the pair
 * has the products M M' = [a b; b c] with root r = sqrt(ac - bb), (M M')^(-1/2) is
 * [c + r, -b; -b, a + r] up to a factor. */
static EDML_NOINLINE int orthonormalise(point *first, point *second)
{
    const real length = HYPOT(norm(*first), norm(*second));
    if (!(length > 0)) return 0;
    *first = over_length(*first, length);
    *second = over_length(*second, length);
    const real a = dot(*first, *first), b = dot(*first, *second), c = dot(*second, *second);
    const real determinant = MUL(a, c) - SQUARE(b); /* <= 1/4, because a + c = 1 */
    if (!(determinant > PARALLEL_SQUARED)) return 0;
    const real root = SQRT(determinant);
    point u = times(c + root, *first), v = times(a + root, *second);
    add_multiple(&u, -b, *second);
    add_multiple(&v, -b, *first);
    *first = over_length(u, norm(u));
    add_multiple(&v, -dot(v, *first), *first); /* nothing but rounding */
    *second = over_length(v, norm(v));
    return 1;
}

/* The camera's first two axes in those of the points; 0 if the image is a line. */
static int camera_axes(const moments *m, real ridge, point *right, point *down)
{
    *right = solve_scaled(m, ridge, m->u);
    *down = solve_scaled(m, ridge, m->v);
    return orthonormalise(right, down);
}

/* Coordinates along the camera's axes. */
static EDML_NOINLINE void to_camera_axes(point x[EDML_JOINTS], const point *right, const point *down)
{
    const point away = cross(*right, *down);
    for (int j = 0; j < EDML_JOINTS; j++) {
        const point rotated = {dot(*right, x[j]), dot(*down, x[j]), dot(away, x[j])};
        x[j] = rotated;
        ASSUME(ALL_WITHIN(x[j], REAL(5.71))); /* those of the MDS as before, along other axes */
    }
}

edml_status edml_orient(point x[EDML_JOINTS], const edml_image *image)
{
    moments m;
    point right, down;
    if (x == NULL || image == NULL) return EDML_ERR_ARGUMENT;
    if ((image->seen & ALL_JOINTS) == 0) return EDML_ERR_DEGENERATE;
    sum_moments(&m, x, image);
    if (!scale_moments(&m) || !camera_axes(&m, ORIENT_LIGHT_RIDGE, &right, &down) ||
        !camera_axes(&m, ORIENT_MIN_RIDGE + orient_residual(&m, right, down), &right, &down))
        return EDML_ERR_DEGENERATE;
    to_camera_axes(x, &right, &down);
    move_origin_to_mean(x);
    return EDML_OK;
}

#endif
