/* SPDX-License-Identifier: MIT */
#include "../network/kernels.h"

#include "../../gen/fconv_w8.h"
