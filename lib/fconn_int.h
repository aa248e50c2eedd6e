/* What fconn_q15.c and fconn_q7.c share: the vocabulary of fconn.inc in whole numbers.  They say
 * NAME, `weight` and `dense_layer` first.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_FCONN_INT_H
#define EDML_FCONN_INT_H

#include <string.h>

#include "model.h"

typedef int32_t value;

/* The EDM, 0 or more, from Q24 to Q12: to nearest, at most EDML_ACTIVATION.  x may be edm. */
static const int32_t *first_input(int32_t *x, const int32_t *edm)
{
    for (int k = 0; k < EDML_PAIRS; k++) {
        const int32_t q12 = ((edm[k] >> (EDML_EDM_SHIFT - 1)) + 1) >> 1;
        x[k] = q12 < EDML_ACTIVATION ? q12 : EDML_ACTIVATION;
    }
    return x;
}

/* From sums, 0 to 2^31 - 1, to activations: times factor / 2^shift, to nearest, at most `most`.
 * factor is 1 to 2^31 - 1, so that the product is below 2^62; shift is 1 to 62. */
static void rescale(int32_t *y, const dense_layer *layer)
{
    for (int row = 0; row < layer->outputs; row++) {
        const uint64_t product = (uint64_t)(uint32_t)y[row] * (uint32_t)layer->factor[row];
        const uint64_t scaled = ((product >> (layer->shift - 1)) + 1) >> 1;
        y[row] = scaled < (uint32_t)layer->most ? (int32_t)scaled : layer->most;
    }
}

#define HASH_FACTORS(hash, layer, rows) \
    ((hash) = hash_values(hash, (layer)->factor, rows, sizeof *(layer)->factor))

#endif
