/* SPDX-License-Identifier: MIT */
#include "../network/kernels.h"

#include "../../gen/direct_f32.h"
