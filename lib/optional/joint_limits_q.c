/* Joint limits in fixed point: for programs that ask for them.
 *
 * SPDX-License-Identifier: MIT
 */
#include "real_q24.h"

#include "limits.h"

#include "vector.inc"
#include "pose.inc"
#include "torso.inc"

#include "limits.inc"
