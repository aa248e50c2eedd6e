/* The vocabulary of the shared stages (*.inc), spoken in float32.
 *
 * A stage says MUL, DIV, SQRT and HYPOT where fixed point must shift, REAL where it must scale a
 * constant, and `wide` where a sum of products needs more bits.  The ranges in the stages'
 * comments are what fixed point relies on.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_REAL_F32_H
#define EDML_REAL_F32_H

#include <math.h>

#include "model.h"

typedef float real;
typedef float wide; /* sums of products */
typedef edml_keypoint keypoint;
typedef edml_point point;
typedef edml_pose pose;
typedef edml_work work_memory;
typedef edml_rotation_f32 rotation;

#define NAME(x) x##_f32
#define edml_lift_f32 edml_lift /* the public name of the float pipeline has no suffix */

#define REAL(constant) constant##F
#define SETTING(number) (number).f32
#define MUL(a, b) ((a) * (b))
#define DIV(a, b) ((a) / (b))
#define SQRT(a) sqrtf(a)
#define HYPOT(a, b) sqrtf((a) * (a) + (b) * (b))
#define ABS(a) fabsf(a)
#define NARROW(sum) (sum)
#define FINITE(a) ((a) - (a) == 0.0F) /* false for NaN and infinity */

#endif
