/* The camera's frame in fixed point: for programs that ask for it, which need not be lifting ones.
 *
 * SPDX-License-Identifier: MIT
 */
#include "real_q24.h"

#include "seen.inc"
#include "vector.inc"
#include "pose.inc"

#include "rotation.inc"

#include "camera.inc"
