/* FConn with left and right alike, in float32.
 *
 * SPDX-License-Identifier: MIT
 */
#include "model.h"

#define NAME(x) x##_f32
typedef float value;
typedef float activation;
typedef float weight;
typedef edml_dense_f32 dense_layer;

static float first_input(float edm) { return edm * edm / (edm + (float)EDML_SOFT / 4096); }

static float activated(float sum, const dense_layer *layer, int row)
{
    (void)layer, (void)row;
    return sum > 0 ? sum : 0;
}

#define HASH_FACTORS(hash, layer, rows) (void)0

#if defined(__GNUC__) && defined(__ARM_FP) && defined(__thumb2__)
#define ROWS "rows_vfp.inc"
#endif

#include "twin.inc"
