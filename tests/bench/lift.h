/* One lift of a made-up pose: of edml_lift, or of edml_lift_q24 with -DFIXED; MODEL is the model.
 *
 * SPDX-License-Identifier: MIT
 */
#ifdef FIXED
#include "real_q24.h"
#else
#include "real_f32.h"
#endif

#ifndef MODEL
#define MODEL edml_fconn_f32
#endif

#define STAGE static __attribute__((noinline)) void /* so that its cost can be told */

static keypoint in[EDML_JOINTS];
static pose out;
static work_memory work;

STAGE stage_lift(void) { NAME(edml_lift)(&out, in, &MODEL, &work); }
