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

/* The EDM, Q24, 0 to 2^31 - 2^24, rounded to Q12 and limited to EDML_ACTIVATION; x may be edm. */
static const int32_t *first_input(int32_t *x, const int32_t *edm)
{
    for (int k = 0; k < EDML_PAIRS; k++) {
        const int32_t q12 = (edm[k] + (1 << EDML_EDM_SHIFT >> 1)) >> EDML_EDM_SHIFT;
        x[k] = q12 < EDML_ACTIVATION ? q12 : EDML_ACTIVATION;
    }
    return x;
}

/* (sum factor + 2^(shift - 1)) >> shift, in one shift of many places: sum, factor < 2^31, shift 1 to
 * 62.  A sum below zero, which C99 does not say how to shift, would become 0 or less. */
static int32_t activation(int32_t sum, const dense_layer *layer, int row)
{
    if (sum <= 0) return 0;
    const uint64_t product = (uint64_t)(uint32_t)sum * (uint32_t)layer->factor[row];
    const uint64_t y = ((product >> (layer->shift - 1)) + 1) >> 1;
    return y < (uint32_t)layer->most ? (int32_t)y : layer->most;
}

#define HASH_FACTORS(hash, layer, rows) \
    ((hash) = hash_values(hash, (layer)->factor, rows, sizeof *(layer)->factor))

#endif
