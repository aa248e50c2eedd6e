/* Angles in degrees, without a library of functions: + - * / alone.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_ANGLE_H
#define EDML_ANGLE_H

#include "../api/api.h"

#define QUARTER_TURN TO_API(REAL(90.0)) /* degrees, as the public interface has them */
#define HALF_TURN (2 * QUARTER_TURN)    /* beyond a real's range in fixed point */

/* The angle whose tangent is y / x, 0 to 90.  x, y >= 0, under 64, not both 0.
 * The angle halfway up the octant is subtracted where that brings the ratio nearer to 0, so that it is within
 * tan(22.5 degrees) = 0.414 of it.  The polynomial, the best of its length, is 2e-7 off there at most. */
static real acute_degrees(real y, real x)
{
    const real least = y < x ? y : x, most = y < x ? x : y;
    const int middle = least > MUL(REAL(0.41421356237309505), most);
    const real ratio = middle ? DIV(least - most, least + most) : DIV(least, most);
    const real square = SQUARE(ratio); /* <= 0.172 */
    const real by_ratio = REAL(57.295774) +
                          MUL(square, -REAL(19.097946) +
                                          MUL(square, REAL(11.437364) +
                                                          MUL(square, -REAL(7.8809278) +
                                                                          MUL(square, REAL(4.4315771)))));
    const real degrees = (middle ? REAL(45.0) : 0) + MUL(ratio, by_ratio);
    return y < x ? degrees : REAL(90.0) - degrees;
}

/* The angle of (x, y) from the x axis towards y, above -180 and up to 180.  |x|, |y| < 64, not both 0.
 * Error < 2e-5 in float, < 1e-5 in fixed point, which rounds to 2^-16 (tests/unit/test_angle.c). */
static api_real degrees_of(real y, real x)
{
    const api_real acute = TO_API(acute_degrees(ABS(y), ABS(x)));
    const api_real above = x < 0 ? HALF_TURN - acute : acute;
    return y < 0 ? -above : above;
}

#endif
