/* What can be done with a lifted pose, in fixed point: for programs that ask for it.
 *
 * SPDX-License-Identifier: MIT
 */
#include "real_q24.h"

#include "seen.inc"
#include "vector.inc"
#include "pose.inc"

#include "person.inc"
#include "quality.inc"
#include "floor.inc"
