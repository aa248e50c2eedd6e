/* SPDX-License-Identifier: MIT */
#include "limits.h"

#include "../gen/joint_limits.h"
