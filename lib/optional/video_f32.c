/* SPDX-License-Identifier: MIT */
#include "../api/api_f32.h"

#include "video.h"
