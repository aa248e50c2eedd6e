/* The vocabulary of the shared stages (*.inc), spoken in whole numbers: a real is an int32_t with 24
 * fraction bits, from -128 to 128 in steps of 6e-8.  What the words mean is said in real_f32.h.
 *
 * Nothing saturates and nothing is checked here: each stage says why its numbers stay in range, and
 * tests/check/check.cpp compiles the stages with numbers that stop at the first one which does not.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_REAL_Q24_H
#define EDML_REAL_Q24_H

#include <float.h>

#include "fixed.h"
#include "model.h"

typedef int32_t real;
typedef int64_t wide;
typedef int32_t pixels; /* Q16 */
typedef edml_keypoint_q16 keypoint;
typedef edml_point_q24 point;
typedef edml_pose_q16 pose;
typedef edml_work_q24 work_memory;
typedef edml_fconv_work_q24 fconv_work_memory;
typedef edml_rotation_q24 rotation;
typedef edml_camera_q16 camera;
typedef edml_placement_q16 placement;
typedef edml_point_q16 placed_point;
typedef edml_person_q16 person;
typedef int32_t reported; /* Q16 */

#define NAME(x) x##_q24

#define REAL(constant) ((real)((constant) * 16777216.0 + 0.5)) /* >= 0; folded by the compiler */
#define SETTING(number) (number).q24
#define FRACTION(a) ((real)(a) * 4096)
#define EPSILON 8
#define MUL(a, b) mul_q24(a, b)
#define DIV(a, b) edml__divide_q24(a, b) /* error <= 1/2 unit in the last place */
#define SQRT(a) sqrt_q24(a)              /* error < 1 unit, not too large */
#define HYPOT(a, b) hypot_q24(a, b, 0)   /* error < 1 unit, not too large; result < 128 */
#define NORM(a, b, c) hypot_q24(a, b, c) /* the same */
#define ABS(a) ((a) < 0 ? -(a) : (a))
#define NARROW(sum) ((real)(sum))
#define PRODUCT(a, b) product_q40(a, b)
#define AS_REAL(sum) saturate_q40(sum)
#define IN_REACH(square) ((square) < INT32_C(64) << 24) /* m^2 */
#define ENDLESS INT64_MAX
#define RESULT(a) (((a) + 128) >> 8)
#define GIVEN(a) ((a) * 256)             /* |a| < 128 */

#define FINITE(a) in_range_q24(a)
#define EXACT_TO (INT32_C(256) << 16) /* pixels: 24 bits, as many as a float has */
#define RUNS(model) ((model)->predict_q24 != NULL)
#define RUNS_FCONV(model) \
    (IS_FCONV(model) && ((const edml_fconv *)(model)->layers)->predict_q24 != NULL)

/* Constants are rounded to Q24 by the compiler: everywhere alike. */
typedef char doubles_hold_24_fraction_bits[DBL_MANT_DIG >= 53 ? 1 : -1];

/* Shifting a negative number to the right must round down, as it does everywhere; C leaves it open. */
typedef char shifts_are_arithmetic[(-3 >> 1) == -2 ? 1 : -1];

/* Coordinates within 8192 pixels; confidences always. */
static inline int in_range_q24(int32_t a) { return a > -(INT32_C(1) << 29) && a < INT32_C(1) << 29; }

/* To the nearest; |a b| < 128. */
static inline real mul_q24(real a, real b)
{
    return (real)(((int64_t)a * b + (INT32_C(1) << 23)) >> 24);
}

static inline wide product_q40(real a, real b) /* rounded down */
{
    return ((int64_t)a * b) >> 8;
}

static inline real saturate_q40(wide sum)
{
    const wide most = (wide)64 << 40;
    return (real)(((sum > most ? most : sum < -most ? -most : sum) + (INT32_C(1) << 15)) >> 16);
}

static inline real sqrt_q24(real a)
{
    return a > 0 ? (real)edml__root((uint64_t)a << 24) : 0;
}

static inline uint64_t square_q24(real a) { return (uint64_t)((int64_t)a * a); } /* <= 2^62 */

static inline real hypot_q24(real a, real b, real c)
{
    return (real)edml__root(square_q24(a) + square_q24(b) + square_q24(c));
}

#endif
