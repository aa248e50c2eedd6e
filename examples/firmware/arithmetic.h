/* What differs between the lift in float and, with -DFIRMWARE_FIXED, in fixed point.
 *
 * SPDX-License-Identifier: MIT
 */
#include "edmlift/fixed.h"

#ifdef FIRMWARE_FIXED

#define MODEL edml_direct_w16
#define LIFT edml_lift_q
typedef edml_keypoint_q keypoint;
typedef edml_pose_q pose;
typedef edml_work_q work_memory;

static int32_t pixels(int32_t hundredths) { return hundredths * 16384 / 25; } /* <= 1310 pixels */
static int16_t confidence(int32_t seen) { return seen ? 32767 : 0; }
static int thousandths(int32_t number) { return (int)(((int64_t)number * 1000 + 32768) >> 16); }

#else

#define MODEL edml_distances_w16
#define LIFT edml_lift
typedef edml_keypoint keypoint;
typedef edml_pose pose;
typedef edml_work work_memory;

static float pixels(int32_t hundredths) { return (float)hundredths / 100.0F; }
static float confidence(int32_t seen) { return seen ? 1.0F : 0.0F; }
static int thousandths(float number) { return (int)(number * 1000.0F + (number < 0.0F ? -0.5F : 0.5F)); }

#endif
