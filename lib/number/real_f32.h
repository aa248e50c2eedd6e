/* The vocabulary of the shared stages (*.inc), spoken in float32; real_q24.h speaks it in whole
 * numbers.
 *
 *   real, wide    a number; one that holds sums beyond the range of a real
 *   REAL(c)       a constant, SETTING(n) an edml_number of the model
 *   FRACTION(a)   a whole number of 1 / EDML_COMPLETION_ONE
 *   MUL DIV SQRT  of reals; DIV is a ratio of any two like numbers
 *   HYPOT NORM    length of a vector of two and of three
 *   ABS NARROW    absolute value; a wide that is known to fit as a real
 *   PRODUCT       of two reals, as a wide of finer fraction, for sums of up to 2^23
 *   AS_REAL       a sum of PRODUCTs as a real; one beyond +-64 as that
 *   IN_REACH      are points apart by the root of this near enough?  ENDLESS: a wide above all sums
 *   EPSILON       what rounding may leave of a zero, absolutely; a float's rounding is relative
 *   FINITE        is a coordinate a number and in range?
 *   EXACT_TO      coordinates are rounded like ones of this magnitude, or more coarsely
 *   RESULT GIVEN  a real as the pose holds it (reported), and back
 *   RUNS          can edml_lift() in this arithmetic run that model?  RUNS_FCONV: edml_lift_fconv()
 *
 * The ranges in the stages' comments are what fixed point relies on.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_REAL_F32_H
#define EDML_REAL_F32_H

#include <math.h>

#include "model.h"

typedef float real;
typedef float wide;
typedef float pixels;
typedef edml_keypoint keypoint;
typedef edml_point point;
typedef edml_pose pose;
typedef edml_work work_memory;
typedef edml_fconv_work fconv_work_memory;
typedef edml_rotation_f32 rotation;
typedef edml_camera camera;
typedef edml_placement placement;
typedef edml_point placed_point;
typedef edml_person person;
typedef float reported;

#define NAME(x) x##_f32
#define edml_lift_f32 edml_lift /* the public names of the float pipeline have no suffix */
#define edml_lift_fconv_f32 edml_lift_fconv
#define edml_place_f32 edml_place
#define edml_place_sweep_f32 edml_place_sweep
#define edml_fit_person_f32 edml_fit_person
#define edml_floor_f32 edml_floor
#define edml_quality_f32 edml_quality
#define edml_limits_f32 edml_limits
#define edml_mirror_by_limits_f32 edml_mirror_by_limits

#define REAL(constant) constant##F
#define SETTING(number) (number).f32
#define FRACTION(a) ((float)(a) * 0x1p-12F)
#define EPSILON 0.0F
#define MUL(a, b) ((a) * (b))
#define DIV(a, b) ((a) / (b))
#define SQRT(a) sqrtf(a)
#define HYPOT(a, b) sqrtf((a) * (a) + (b) * (b))
#define NORM(a, b, c) sqrtf((a) * (a) + (b) * (b) + (c) * (c))
#define ABS(a) fabsf(a)
#define NARROW(sum) (sum)
#define PRODUCT(a, b) ((a) * (b))
#define AS_REAL(sum) (sum)
#define IN_REACH(square) 1
#define ENDLESS HUGE_VALF
#define RESULT(a) (a)
#define GIVEN(a) (a)

/* The compiler may then take it for granted that there is no NaN, and lift one to a pose. */
#if defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__
#error "edmlift refuses NaN and infinity: compile it without -ffast-math and -ffinite-math-only"
#endif
#define FINITE(a) ((a) - (a) == 0.0F) /* false for NaN and infinity */
#define EXACT_TO 0x1p-125F            /* below, floats lose bits */
#define RUNS(model) (!IS_FCONV(model))
#define RUNS_FCONV(model) IS_FCONV(model)

#endif
