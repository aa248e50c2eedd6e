/* SPDX-License-Identifier: MIT */
#include "../api/api_q.h"

#include "camera/focal.h"
#include "camera/lift_with_camera.h"
#include "camera/path.h"
#include "camera/pnp.h"
