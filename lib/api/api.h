/* The public types in the arithmetic of this translation unit: float32, unless it included another
 * api_*.h first.  Every stage text includes this, so that it compiles alone.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_API_H
#include "api_f32.h"
#endif
