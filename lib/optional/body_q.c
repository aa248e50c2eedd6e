/* SPDX-License-Identifier: MIT */
#include "../api/api_q.h"

#include "body.h"
#include "measure_body.h"
#include "quality.h"
#include "stand.h"
