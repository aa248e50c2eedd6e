/* The direction of a public vector of any length.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_UNIT_VECTOR_H
#define EDML_UNIT_VECTOR_H

#include "vector.h"

/* EDML_ERR_NOT_FINITE; EDML_ERR_DEGENERATE if it has no direction. */
static edml_status unit_vector(point *out, edml_point a)
{
    if (!(IS_FINITE(a.x) && IS_FINITE(a.y) && IS_FINITE(a.z))) return EDML_ERR_NOT_FINITE;
    api_real largest = ABS(a.x);
    if (ABS(a.y) > largest) largest = ABS(a.y);
    if (ABS(a.z) > largest) largest = ABS(a.z);
    if (!(largest > 0)) return EDML_ERR_DEGENERATE;
    /* no component is longer than the longest */
    const point p = {DIV_TO(REAL(1.0), a.x, largest), DIV_TO(REAL(1.0), a.y, largest),
                     DIV_TO(REAL(1.0), a.z, largest)};
    const real length = norm(p);
    ASSUME(length >= REAL(1.0)); /* that of the largest */
    *out = over_length(p, length);
    return EDML_OK;
}

#endif
