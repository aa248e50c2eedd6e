/* SPDX-License-Identifier: MIT */
#include "../network/kernels.h"

#include "../../gen/distances_w8.h"
