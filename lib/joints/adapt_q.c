/* Adapters of edml_keypoint_q16: coordinates are Q16, what they are multiplied by is Q24.
 *
 * SPDX-License-Identifier: MIT
 */
#include "real_q24.h"

typedef int16_t confidence;
#define edml_adapt_q24 edml_adapt_q16

#include "adapt.inc"
