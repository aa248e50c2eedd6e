/* FConv in whole numbers, weights of up to 8 bits.
 *
 * SPDX-License-Identifier: MIT
 */
#include "model.h"

#define NAME(x) x##_q7
typedef int16_t activation;
typedef int8_t weight;
typedef edml_dense_q7 dense_layer;
typedef edml_fconv_maps_q7 maps;

#include "net_int.h"

static int16_t first_input(int32_t edm) { return (int16_t)edm_value(edm, EDML_EDM_SHIFT); }

static int16_t activated(int32_t sum, const dense_layer *layer, int row)
{
    return (int16_t)rescaled(sum, layer, row); /* its `most` is EDML_ACTIVATION */
}

/* |a|, |b| < 2^30, which the exporter proves; the layer's factor halves their sum. */
static int32_t distance_of(int32_t a, int32_t b, const dense_layer *layer)
{
    return a + b > 0 ? rescaled(a + b, layer, 0) : 0;
}

#include "fconv.inc"
