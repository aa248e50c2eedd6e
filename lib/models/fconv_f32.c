/* SPDX-License-Identifier: MIT */
#include "model.h"

#include "../gen/fconv_f32.h"
