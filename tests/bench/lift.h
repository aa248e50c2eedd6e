/* One lift of a made-up pose: of edml_lift, or of edml_lift_q24 with -DFIXED; of their twins for FConv
 * with -DFCONV; MODEL is the model.
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
#ifdef FCONV
static fconv_work_memory fconv_work;
#define work (fconv_work.lift)
STAGE stage_lift(void) { NAME(edml_lift_fconv)(&out, in, &MODEL, &fconv_work); }
#else
static work_memory work;
STAGE stage_lift(void) { NAME(edml_lift)(&out, in, &MODEL, &work); }
#endif
