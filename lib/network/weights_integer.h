/* What weights_w16.h and weights_w8.h share; weights_f32.h says what the words mean.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_WEIGHTS_INTEGER_H
#define EDML_WEIGHTS_INTEGER_H

#ifndef EDML_WEIGHTS_H
#include "weights_w16.h" /* alone: with these */
#endif

#include "../number/fixed.h"

typedef int32_t value;

/* From Q24, 0 or more, to Q12 below 8, to the nearest. */
static inline int32_t network_input(int32_t distance)
{
    const int32_t limit = (INT32_C(1) << (27 - EDML_INPUT_SHIFT)) - 1;
    const int32_t rounded = ((distance >> (EDML_INPUT_SHIFT - 1)) + 1) >> 1;
    return rounded < limit ? rounded : limit;
}

/* From Q24 within +-8 to Q12, to the nearest; -32768 to 32767. */
static inline int32_t signed_input(int32_t number)
{
    const int32_t rounded = ((number >> (EDML_INPUT_SHIFT - 1)) + 1) >> 1;
    return rounded < 32767 ? rounded : 32767;
}

/* A row's sum, 0 to 2^31 - 1, times multiplier / 2^shift, to the nearest, at most `clamp`.  multiplier is
 * 1 to 2^31 - 1, so that the product is below 2^62; shift is 1 to 62. */
static inline int32_t requantise(int32_t sum, const dense_layer *layer, int row)
{
    const uint64_t product = (uint64_t)edml__product(sum, layer->multiplier[row]);
    const uint64_t scaled = ((product >> (layer->shift - 1)) + 1) >> 1;
    return scaled < (uint32_t)layer->clamp ? (int32_t)scaled : layer->clamp;
}

static inline int32_t activate(int32_t sum, const dense_layer *layer, int row)
{
    return sum > 0 ? requantise(sum, layer, row) : 0;
}

/* |sum| < 2^31, which the exporter proves. */
static inline int32_t signed_output(int32_t sum, const dense_layer *layer, int row)
{
    return sum < 0 ? -requantise(-sum, layer, row) : requantise(sum, layer, row);
}

/* |a|, |b| < 2^30, which the exporter proves; the layer's multiplier halves their sum. */
static inline int32_t mean_output(int32_t a, int32_t b, const dense_layer *layer)
{
    return activate(a + b, layer, 0);
}

#define HASH_MULTIPLIERS(hash, layer, rows)                                                                \
    ((hash) = hash_values(hash, (layer)->multiplier, rows, sizeof *(layer)->multiplier))

#endif
