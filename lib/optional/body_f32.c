/* What can be done with a lifted pose, in float32: for programs that ask for it.
 *
 * SPDX-License-Identifier: MIT
 */
#include "real_f32.h"

#include "seen.inc"
#include "vector.inc"
#include "pose.inc"

#include "person.inc"
#include "quality.inc"
#include "floor.inc"
