/* SPDX-License-Identifier: MIT */
#include "../network/kernels.h"

#include "../../gen/fconv_f32.h"
