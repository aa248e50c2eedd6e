/* SPDX-License-Identifier: MIT */
#include "model.h"

#include "../gen/fconn_f32.h"
