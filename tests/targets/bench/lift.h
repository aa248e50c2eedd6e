/* One lift of a made-up pose, with MODEL: in float, or in fixed point with -DFIXED; with the work memory of
 * FConv with -DFCONV.
 *
 * SPDX-License-Identifier: MIT
 */
#ifdef FIXED
#include "api/api_q.h"
#else
#include "api/api_f32.h"
#endif
#include "network/model.h"

#ifndef MODEL
#define MODEL edml_distances_f32
#endif

#if defined(FCONV) && defined(FIXED)
typedef edml_fconv_work_q work_memory;
#elif defined(FCONV)
typedef edml_fconv_work work_memory;
#else
typedef edml_work work_memory;
#endif

#define STAGE static __attribute__((noinline)) void /* so that its cost can be told */

static edml_keypoint in[EDML_JOINTS];
static edml_pose out;
static work_memory work;

STAGE stage_lift(void) { edml_lift(&out, in, NULL, &MODEL, &work, sizeof work); }

/* What follows the lift, where it is asked for. */
static api_real degrees[EDML_ANGLES];
STAGE stage_angles(void) { edml_angles(degrees, &out, NULL); }
