/* FConv in float32.
 *
 * SPDX-License-Identifier: MIT
 */
#include "model.h"

#define NAME(x) x##_f32
typedef float value;
typedef float activation;
typedef float weight;
typedef edml_dense_f32 dense_layer;
typedef edml_fconv_maps_f32 maps;

static float first_input(float edm) { return edm; }

static float activated(float sum, const dense_layer *layer, int row)
{
    (void)layer, (void)row;
    return sum;
}

static float distance_of(float a, float b, const dense_layer *layer)
{
    (void)layer;
    return a + b > 0 ? (a + b) * 0.5F : 0;
}

#define HASH_FACTORS(hash, layer, rows) (void)0

#if defined(__GNUC__) && defined(__ARM_FP) && defined(__thumb2__)
#define ROWS "rows_vfp.inc"
#endif

#include "fconv.inc"
