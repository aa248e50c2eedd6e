/* SPDX-License-Identifier: MIT */
#include "weights_f32.h"

#include "fconn.h"
