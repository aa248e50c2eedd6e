/* SPDX-License-Identifier: MIT */
#include "../api/api_q.h"

#include "video.h"
