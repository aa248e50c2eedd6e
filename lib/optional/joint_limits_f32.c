/* Joint limits in float32: for programs that ask for them.
 *
 * SPDX-License-Identifier: MIT
 */
#include "real_f32.h"

#include "limits.h"

#include "vector.inc"
#include "pose.inc"
#include "torso.inc"

#include "limits.inc"
