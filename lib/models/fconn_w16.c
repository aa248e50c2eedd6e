/* SPDX-License-Identifier: MIT */
#include "../network/kernels.h"

#include "../../gen/fconn_w16.h"
