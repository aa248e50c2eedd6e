/* SPDX-License-Identifier: MIT */
#include "model.h"

#include "../gen/fconn_q15.h"
