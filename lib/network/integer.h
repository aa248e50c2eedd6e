/* What networks in whole numbers share.  Who includes this says `dense_layer` first.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_NET_INT_H
#define EDML_NET_INT_H

#include "model.h"

typedef int32_t value;

/* A distance of the EDM, 0 or more, from Q24 shifted to the right: to nearest, below 8. */
static int32_t edm_value(int32_t q24, int shift)
{
    const int32_t most = (INT32_C(1) << (27 - shift)) - 1, rounded = ((q24 >> (shift - 1)) + 1) >> 1;
    return rounded < most ? rounded : most;
}

/* From a sum of a row, 0 to 2^31 - 1, to its activation: times factor / 2^shift, to nearest, at most
 * `most`.  factor is 1 to 2^31 - 1, so that the product is below 2^62; shift is 1 to 62. */
static int32_t rescaled(int32_t sum, const dense_layer *layer, int row)
{
    const uint64_t product = (uint64_t)(uint32_t)sum * (uint32_t)layer->factor[row];
    const uint64_t scaled = ((product >> (layer->shift - 1)) + 1) >> 1;
    return scaled < (uint32_t)layer->most ? (int32_t)scaled : layer->most;
}

#define HASH_FACTORS(hash, layer, rows) \
    ((hash) = hash_values(hash, (layer)->factor, rows, sizeof *(layer)->factor))

#endif
