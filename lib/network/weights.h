/* The weights of this translation unit: float32, unless it included another weights_*.h first.  Every
 * network's text includes this, so that it compiles alone.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_WEIGHTS_H
#include "weights_f32.h"
#endif
