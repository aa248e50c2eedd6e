/* SPDX-License-Identifier: MIT */
#define EDML_NARROW_ACTIVATIONS
#include "weights_w8.h"

#include "fconv.h"
