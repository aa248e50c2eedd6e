/* FConn in whole numbers, weights of up to 16 bits.
 *
 * SPDX-License-Identifier: MIT
 */
#include "model.h"

#define NAME(x) x##_q15
typedef int16_t weight;
typedef edml_dense_q15 dense_layer;

#include "fconn_int.h"

#if defined(__GNUC__) && defined(__ARM_FEATURE_DSP) && defined(__thumb2__) && !defined(__ARM_BIG_ENDIAN)
#define ROWS "rows_dsp.inc"
#endif

#include "fconn.inc"
