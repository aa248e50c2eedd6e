/* SPDX-License-Identifier: MIT */
#include "../network/kernels.h"

#include "../../gen/direct_w8.h"
