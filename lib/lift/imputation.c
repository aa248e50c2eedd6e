/* SPDX-License-Identifier: MIT */
#include "edmlift/stages.h"

#include "../../gen/imputation.h"
