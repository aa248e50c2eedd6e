/* Absolute orientation: the rotation that brings points best onto others (Horn, "Closed-form solution of absolute
 * orientation using unit quaternions", 1987).  lift/align.h has a faster way, to a rotation or a reflection,
 * whichever is nearer.  A placement needs a rotation, also where a reflection is nearer.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_HORN_H
#define EDML_HORN_H

#include "../../geometry/rotation.h"

/* Rotation of the quaternion (w, v), whose square is between 1/4 and 64.  Out of line, so that its locals are
 * not on the stack while others divide. */
static EDML_NOINLINE matrix3 quaternion_rotation(real w, point v)
{
    const real square = SQUARE(w) + dot(v, v);
    ASSUME(REAL(0.24) <= square && square <= REAL(64.0)); /* 1/4 or more, but for rounding */
    const real ratio = DIV(REAL(2.0), square);
    const point a = times(ratio, v);
    const real xx = MUL(a.x, v.x), yy = MUL(a.y, v.y), zz = MUL(a.z, v.z);
    const real xy = MUL(a.x, v.y), xz = MUL(a.x, v.z), yz = MUL(a.y, v.z);
    const real wx = MUL(a.x, w), wy = MUL(a.y, w), wz = MUL(a.z, w);
    const matrix3 r = {{REAL(1.0) - yy - zz, xy - wz, xz + wy},
                       {xy + wz, REAL(1.0) - xx - zz, yz - wx},
                       {xz - wy, yz + wx, REAL(1.0) - xx - yy}};
    ASSUME(ARE_UNIT_VECTORS(r)); /* its rows */
    return r;
}

enum { SQUARINGS = 10 };
#define PURE_TRACE REAL(0.9999) /* of the square of a matrix of trace 1: one eigenvector is left */

typedef struct {
    real at[4][4];
} horn_matrix;

/* Horn's N for points p that are to be rotated onto q; sum q p' = m, whose squares add up to 1.  It is
 * shifted to have no negative eigenvalue, and divided by its trace. */
static horn_matrix horn_matrix_of(const matrix3 *m)
{
    const real shift = REAL(1.75); /* > sqrt(3), at which N's eigenvalues end */
    const real xx = m->x.x, yy = m->y.y, zz = m->z.z;
    horn_matrix n = {{{xx + yy + zz + shift, m->z.y - m->y.z, m->x.z - m->z.x, m->y.x - m->x.y},
                      {0, xx - yy - zz + shift, m->x.y + m->y.x, m->x.z + m->z.x},
                      {0, 0, yy - xx - zz + shift, m->y.z + m->z.y},
                      {0, 0, 0, zz - xx - yy + shift}}};
    for (int i = 0; i < 4; i++) {
        for (int j = i; j < 4; j++) {
            n.at[i][j] = MUL(n.at[i][j], REAL(0.14285714285714286)); /* 1/7 */
            n.at[j][i] = n.at[i][j];
        }
    }
    return n;
}

/* Squares a matrix of trace 1 and divides it by its trace.  Returns that trace: 1/4 to 1. */
static real square_and_scale(horn_matrix *n)
{
    horn_matrix square;
    real trace = 0;
    for (int i = 0; i < 4; i++) {
        for (int j = i; j < 4; j++) {
            const real *const a = n->at[i], *const b = n->at[j]; /* column j is row j */
            wide sum = 0;
            for (int k = 0; k < 4; k++) sum += EXACT(a[k], b[k]);
            square.at[i][j] = FROM_EXACT(sum);
        }
        trace += square.at[i][i];
    }
    /* of eigenvalues that are not negative and add up to 1 */
    ASSUME(REAL(0.24) <= trace && trace <= REAL(1.01));
    const real scale = DIV(REAL(1.0), trace);
    for (int i = 0; i < 4; i++)
        for (int j = i; j < 4; j++) {
            n->at[i][j] = MUL(scale, square.at[i][j]);
            ASSUME(WITHIN(n->at[i][j], REAL(1.01))); /* nor is an entry larger than the trace */
            n->at[j][i] = n->at[i][j];
        }
    return trace;
}

/* Divides a matrix by the root of the sum of its squares; returns 0 if it is zero. */
static int to_unit_size(matrix3 *m)
{
    const real x = norm(m->x), y = norm(m->y), z = norm(m->z);
    ASSUME(x <= REAL(50.0) && y <= REAL(50.0) && z <= REAL(50.0)); /* of any matrix here */
    const real size = NORM(x, y, z);
    if (!(size > EPSILON)) return 0;
    m->x = over_length(m->x, size);
    m->y = over_length(m->y, size);
    m->z = over_length(m->z, size);
    return 1;
}

/* The rotation r of the largest trace(r' m), whatever the sign of m's determinant; m is of unit size.  Its quaternion
 * is N's eigenvector of the largest eigenvalue: repeated squaring leaves only that one in the matrix. */
static matrix3 nearest_to_unit(const matrix3 *m)
{
    horn_matrix n = horn_matrix_of(m);
    for (int k = 0; k < SQUARINGS; k++)
        if (square_and_scale(&n) > PURE_TRACE) break;
    int best = 0;
    for (int k = 1; k < 4; k++)
        if (n.at[k][k] > n.at[best][best]) best = k;
    const point v = {n.at[best][1], n.at[best][2], n.at[best][3]};
    const real scale = REAL(2.0); /* the column's square is its largest entry, 1/4 to 1 */
    return quaternion_rotation(MUL(scale, n.at[best][0]), times(scale, v));
}

/* The same of any matrix; returns 0 if it is zero. */
static inline int nearest_rotation(matrix3 *r, const matrix3 *m)
{
    matrix3 unit = *m;
    if (!to_unit_size(&unit)) return 0;
    *r = nearest_to_unit(&unit);
    return 1;
}

#endif
