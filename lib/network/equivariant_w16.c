/* SPDX-License-Identifier: MIT */
#include "weights_w16.h"

#include "equivariant.h"
