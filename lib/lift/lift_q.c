/* The stages in fixed point, in the order in which data flow.
 *
 * SPDX-License-Identifier: MIT
 */
#include "real_q24.h"

#include "seen.inc"
#include "vector.inc"

#include "complete.inc"
#include "edm.inc"
#include "jacobi.inc"
#include "mds.inc"
#include "refine.inc"
#include "torso.inc"
#include "mirror.inc"
#include "orient.inc"
#include "blend.inc"
#include "lift.inc"
