/* From the axes of the MDS to those of the points that a network gives as well, and the mean of the two.
 *
 * The MDS knows neither axes nor the mirror image.  Of all rotations, with a reflection or without, the one
 * that brings its points nearest to the network's is taken (the orthogonal Procrustes problem).
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_ALIGN_H
#define EDML_ALIGN_H

#include "../geometry/rotation.h"
#include "../network/model.h"

/* An eighth of the sum of the products of two sets of centred points.  The squares of x add up to at most 105,
 * as those of any distances up to 3 m do, and those of onto, within 6 m on each axis, to 1512: the squares of
 * the entries of m add up to less than 50^2. */
static matrix3 sum_products(const point onto[EDML_JOINTS], const point x[EDML_JOINTS])
{
    matrix3 m = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    for (int j = 0; j < EDML_JOINTS; j++) {
        const point eighth = {x[j].x / 8, x[j].y / 8, x[j].z / 8};
        add_multiple(&m.x, onto[j].x, eighth);
        add_multiple(&m.y, onto[j].y, eighth);
        add_multiple(&m.z, onto[j].z, eighth);
    }
    /* squares add up to less than that of 50 */
    ASSUME(ALL_WITHIN(m.x, REAL(50.0)) && ALL_WITHIN(m.y, REAL(50.0)) && ALL_WITHIN(m.z, REAL(50.0)));
    return m;
}

/* Reverses a matrix of unit size if its determinant is negative; returns whether it did. */
static int reverse_left_handed(matrix3 *m)
{
    const point zero = {0, 0, 0};
    if (dot(m->x, cross(m->y, m->z)) >= 0) return 0;
    m->x = minus(zero, m->x);
    m->y = minus(zero, m->y);
    m->z = minus(zero, m->z);
    return 1;
}

void edml_align(point x[EDML_JOINTS], const point onto[EDML_JOINTS], const edml_model *model)
{
    const real share = PARAM(model->mds_share);
    matrix3 m = sum_products(onto, x);
    const int found = to_unit_size(&m), reflected = found && reverse_left_handed(&m);
    const real signed_share = reflected ? -share : share;
    if (found) m = nearest_to_unit(&m); /* in the place of the matrix, which saves stack */
    for (int j = 0; j < EDML_JOINTS; j++) {
        const point to = onto[j], turned = found ? rotate(&m, x[j]) : to;
        x[j].x = to.x + MUL(signed_share, turned.x) - MUL(share, to.x);
        x[j].y = to.y + MUL(signed_share, turned.y) - MUL(share, to.y);
        x[j].z = to.z + MUL(signed_share, turned.z) - MUL(share, to.z);
    }
}

#endif
