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

static edml_measured_body measured;
STAGE stage_measure_body(void)
{
    edml_measure_start(&measured);
    edml_measure_body(&measured, &out);
}

/* Someone who stays 4 m away, 30 times a second. */
static edml_path path;
static edml_placement followed;
STAGE stage_path_follow(void)
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        followed.joint[j] = out.joint[j];
        followed.joint[j].z += TO_API(REAL(4.0));
    }
    followed.translation.x = followed.translation.y = 0;
    followed.translation.z = TO_API(REAL(4.0));
    edml_path_follow(&path, &followed, path.time + 33);
}
