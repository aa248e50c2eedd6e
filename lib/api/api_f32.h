/* The public names and types in float32, where they have no suffix; and the words for them.
 *
 *   point            a vector of reals, metres
 *   pixels           an image coordinate
 *   confidence       of a keypoint
 *   api_real         a real as a pose holds it; TO_API and FROM_API convert
 *   NO_ANGLE         in the place of an angle that a pose does not have
 *   IS_FINITE        is a pixel coordinate or a confidence a number, and in range?
 *   MIN_MAGNITUDE    the smallest coordinate with full relative precision
 *   MAX_PIXELS       the largest that is finite
 *   API_MAX          larger than all else: stands for "not known"
 *   MAX_SLOPE        of a one-euro filter
 *   PIXELS(n)        n pixels, an integer
 *   PARAM(n)         an edml_number of the model
 *   WORK_BYTES(m)    work memory of a lift with the model; 0: it cannot be run
 *   RUN_NETWORK      runs the model's network
 *   SCALE(m)         what makes points of the distances that the model gives
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_API_H
#define EDML_API_H

#include <float.h>

#include "edmlift.h"
#include "edmlift/angles.h"
#include "edmlift/body.h"
#include "edmlift/camera.h"
#include "edmlift/many.h"
#include "edmlift/stages.h"
#include "edmlift/video.h"

#include "../number/compiler.h"
#include "../number/real_f32.h"

typedef edml_point point;
typedef float pixels;
typedef float confidence;
typedef float api_real;

#define TO_API(a) (a)
#define FROM_API(a) (a)
#define NO_ANGLE NAN
#define IS_FINITE(a) ((a) - (a) == 0.0F) /* false for NaN and infinity */
#define MAX_PIXELS FLT_MAX
#define API_MAX HUGE_VALF
#define MAX_SLOPE FLT_MAX
#define MIN_MAGNITUDE 0x1p-125F /* below, floats lose bits */
#define PIXELS(n) n##.0F
#define PARAM(number) (number).f32
#define WORK_BYTES(model) (model)->work_bytes
#define RUN_NETWORK edml__run_network
#define SCALE(model) (model)->scale_f32

#endif
