/* SPDX-License-Identifier: MIT */
#include "model.h"

#include "../gen/fconn_q7.h"
