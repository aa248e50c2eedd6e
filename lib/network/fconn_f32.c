/* FConn in float32.
 *
 * SPDX-License-Identifier: MIT
 */
#include <string.h>

#include "model.h"

#define NAME(x) x##_f32
typedef float value;
typedef float activation;
typedef float weight;
typedef edml_dense_f32 dense_layer;

static const float *first_input(float *x, const float *edm)
{
    (void)x; /* no conversion, no copy */
    return edm;
}

static void rescale(float *y, const dense_layer *layer) { (void)y, (void)layer; }

#define HASH_FACTORS(hash, layer, rows) (void)0

#if defined(__GNUC__) && defined(__ARM_FP) && defined(__thumb2__)
#define ROWS "rows_vfp.inc"
#endif

#include "fconn.inc"
