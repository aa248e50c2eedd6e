/* Networks in integers, with weights of up to 16 bits.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_WEIGHTS_H
#define EDML_WEIGHTS_H

#include "model.h"

#define WEIGHTS(name) name##_w16
typedef int32_t activation;
typedef int16_t weight;
typedef edml_dense_w16 dense_layer;

#include "weights_integer.h"

#if defined(__GNUC__) && defined(__ARM_FEATURE_DSP) && defined(__thumb2__) && !defined(__ARM_BIG_ENDIAN)
#define DOT8 "dot8_dsp.h"
#endif

#endif
