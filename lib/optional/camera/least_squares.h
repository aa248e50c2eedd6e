/* Least squares of three and of six unknowns, by normal equations.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_LEAST_SQUARES_H
#define EDML_LEAST_SQUARES_H

#include "../../geometry/rotation.h"

#define SINGULAR_PIVOT REAL(0.000244140625) /* 2^-12: pivots up to this are zero */
#define MAX_SOLUTION REAL(8.0)              /* solutions beyond it are none */

static const matrix3 zero_matrix = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};

/* Is a numerator, a sum of products, over a pivot within MAX_SOLUTION? */
static int is_solution(wide numerator, real pivot)
{
    const wide most = PRODUCT(MAX_SOLUTION, pivot);
    return -most < numerator && numerator < most;
}

/* Solves A x = b for a symmetric positive A by elimination; returns 0 if there is no solution whose components
 * are below MAX_SOLUTION, or if A is nearly singular: an entry is 64 times the pivot.  A's entries are 2 at most
 * in space; in the image, of points that are no person's, a search found 84 (tests/overflow).  A numerator over
 * a pivot d is below sqrt(d) times the root of A's largest entry. */
static int solve3(point *x, const matrix3 *a, point b)
{
    const real one = REAL(1.0);
    if (!(a->x.x > SINGULAR_PIVOT) || ABS(a->x.y) / 64 >= a->x.x || ABS(a->x.z) / 64 >= a->x.x) return 0;
    const real yx = DIV(a->x.y, a->x.x), zx = DIV(a->x.z, a->x.x);
    const real yy = a->y.y - MUL(yx, a->x.y), yz = a->y.z - MUL(yx, a->x.z);
    if (!(yy > SINGULAR_PIVOT) || ABS(yz) / 64 >= yy) return 0;
    const real zy = DIV(yz, yy);
    const real zz = a->z.z - MUL(zx, a->x.z) - MUL(zy, yz);
    b.y -= MUL(yx, b.x);
    b.z -= MUL(zx, b.x) + MUL(zy, b.y);
    if (!(zz > SINGULAR_PIVOT) || !is_solution(PRODUCT(b.z, one), zz)) return 0;
    x->z = DIV(b.z, zz);
    if (!is_solution(PRODUCT(b.y, one), yy)) return 0;
    if (!is_solution(PRODUCT(b.y, one) - PRODUCT(yz, x->z), yy)) return 0;
    x->y = DIV(b.y, yy) - MUL(zy, x->z); /* both below 16 */
    const wide rest = PRODUCT(b.x, one) - PRODUCT(a->x.y, x->y) - PRODUCT(a->x.z, x->z);
    if (!is_solution(rest, a->x.x)) return 0;
    x->x = DIV(b.x - MUL(a->x.y, x->y) - MUL(a->x.z, x->z), a->x.x);
    return 1;
}

/* Adds a b'. */
static void add_product(matrix3 *sum, point a, point b)
{
    sum->x = plus(sum->x, times(a.x, b));
    sum->y = plus(sum->y, times(a.y, b));
    sum->z = plus(sum->z, times(a.z, b));
}

/* Adds a a', upper triangle. */
static void add_square(matrix3 *sum, point a)
{
    sum->x = plus(sum->x, times(a.x, a));
    sum->y.y += SQUARE(a.y);
    sum->y.z += MUL(a.y, a.z);
    sum->z.z += SQUARE(a.z);
}

/* Normal equations of a translation and a rotation vector. */
typedef struct {
    matrix3 translation, both, rotation; /* both: rotation times translation */
    point to_translation, to_rotation;
} equations;

/* Adds the square of what one direction misses. */
static void add_miss(equations *n, point across, point lever, real miss)
{
    add_square(&n->translation, across);
    add_product(&n->both, lever, across);
    add_square(&n->rotation, lever);
    n->to_translation = minus(n->to_translation, times(miss, across));
    n->to_rotation = minus(n->to_rotation, times(miss, lever));
}

/* The translation is eliminated first. */
static int solve_step(point *translation, point *rotation, equations *n)
{
    point unrotated;
    matrix3 k;
    if (!solve3(&unrotated, &n->translation, n->to_translation) ||
        !solve3(&k.x, &n->translation, n->both.x) || !solve3(&k.y, &n->translation, n->both.y) ||
        !solve3(&k.z, &n->translation, n->both.z))
        return 0;
    n->rotation.x = minus(n->rotation.x, rotate(&k, n->both.x));
    n->rotation.y = minus(n->rotation.y, rotate(&k, n->both.y));
    n->rotation.z = minus(n->rotation.z, rotate(&k, n->both.z));
    if (!solve3(rotation, &n->rotation, minus(n->to_rotation, rotate(&n->both, unrotated)))) return 0;
    *translation = minus(unrotated, rotate_back(&k, *rotation));
    return 1;
}

#endif
