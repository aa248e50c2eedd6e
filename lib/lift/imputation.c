/* SPDX-License-Identifier: MIT */
#include "edmlift.h"

#include "../gen/completion.h"
