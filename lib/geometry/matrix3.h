/* Matrices of three by three.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_MATRIX3_H
#define EDML_MATRIX3_H

#include "vector.h"

/* A matrix by its rows; a rotation's are the axes of one frame in those of another. */
typedef struct {
    point x, y, z;
} matrix3;

static inline point rotate(const matrix3 *by, point p)
{
    const point q = {dot(by->x, p), dot(by->y, p), dot(by->z, p)};
    return q;
}

#endif
