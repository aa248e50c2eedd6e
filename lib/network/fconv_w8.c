/* SPDX-License-Identifier: MIT */
#include "weights_w8.h"

#include "fconv.h"
