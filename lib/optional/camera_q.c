/* SPDX-License-Identifier: MIT */
#include "../api/api_q.h"

#include "camera/lift_with_camera.h"
#include "camera/pnp.h"
