/* SPDX-License-Identifier: MIT */
#include "joint_limit_maps.h"

#include "../../gen/joint_limits.h"
