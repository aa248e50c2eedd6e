/* The camera's frame in float32: for programs that ask for it, which need not be lifting ones.
 *
 * SPDX-License-Identifier: MIT
 */
#include "real_f32.h"

#include "seen.inc"
#include "vector.inc"
#include "pose.inc"

#include "rotation.inc"

#include "camera.inc"
