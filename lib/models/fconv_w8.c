/* SPDX-License-Identifier: MIT */
#include "model.h"

#include "../gen/fconv_q7.h"
