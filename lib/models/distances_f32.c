/* SPDX-License-Identifier: MIT */
#include "../network/kernels.h"

#include "../../gen/distances_f32.h"
