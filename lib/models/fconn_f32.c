/* SPDX-License-Identifier: MIT */
#include "../network/kernels.h"

#include "../../gen/fconn_f32.h"
