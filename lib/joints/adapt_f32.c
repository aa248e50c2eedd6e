/* Adapters of edml_keypoint.
 *
 * SPDX-License-Identifier: MIT
 */
#include "real_f32.h"

typedef float confidence;
#define edml_adapt_f32 edml_adapt /* as edml_lift */

#include "adapt.inc"
