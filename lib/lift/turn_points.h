/* Points from a basis to the one before: by the reflection of householder.h, and by the rotations of tridiagonal.h.  In
 * portable C.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_TURN_POINTS_H
#define EDML_TURN_POINTS_H

#include "../geometry/vector.h"
#include "jacobi.h"

/* m points y, each coordinate of them, by I - w w'. */
static EDML_NOINLINE void reflect_points(point *y, const real *w, int m)
{
    wide x_along = 0, y_along = 0, z_along = 0;
    for (int i = 0; i < m; i++) {
        x_along += EXACT(w[i], y[i].x);
        y_along += EXACT(w[i], y[i].y);
        z_along += EXACT(w[i], y[i].z);
    }
    /* 1.415 * 5.7: rows of coordinates are no longer than the root of an eigenvalue */
    ASSUME(WITHIN(x_along, EXACT(REAL(8.1), REAL(1.0))) && WITHIN(y_along, EXACT(REAL(8.1), REAL(1.0))) &&
           WITHIN(z_along, EXACT(REAL(8.1), REAL(1.0))));
    const point along = {FROM_EXACT(x_along), FROM_EXACT(y_along), FROM_EXACT(z_along)};
    for (int i = 0; i < m; i++) {
        y[i].x -= MUL(w[i], along.x);
        y[i].y -= MUL(w[i], along.y);
        y[i].z -= MUL(w[i], along.z);
        ASSUME(ALL_WITHIN(y[i], REAL(5.71))); /* a reflection changes no length */
    }
}

static void rotate_points(point *p, point *q, edml_plane_rotation by)
{
    ASSUME(WITHIN(by.cosine, REAL(1.001)) && WITHIN(by.sine, REAL(1.001))); /* the record of sweep() */
    rotate_pair(&p->x, &q->x, by.cosine, by.sine);
    rotate_pair(&p->y, &q->y, by.cosine, by.sine);
    rotate_pair(&p->z, &q->z, by.cosine, by.sine);
    /* a rotation, of coordinates within 5.7 */
    ASSUME(ALL_WITHIN(*p, REAL(5.71)) && ALL_WITHIN(*q, REAL(5.71)));
}

/* n + 1 points, by the n rotations of a sweep; done: behind the last of them. */
static EDML_NOINLINE void undo_sweep(point *y, const edml_plane_rotation *done, int n)
{
    for (int i = 0; i < n; i++) rotate_points(&y[i + 1], &y[i], *--done);
}

#endif
