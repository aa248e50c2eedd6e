/* What weights_w16.h and weights_w8.h share; weights_f32.h says what the words mean.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_WEIGHTS_INTEGER_H
#define EDML_WEIGHTS_INTEGER_H

#ifndef EDML_WEIGHTS_H
#include "weights_w16.h" /* alone: with these */
#endif

typedef int32_t value;

/* From Q24, 0 or more, to Q12 below 8, to the nearest. */
static inline int32_t network_input(int32_t distance)
{
    const int32_t limit = (INT32_C(1) << (27 - EDML_EDM_SHIFT)) - 1;
    const int32_t rounded = ((distance >> (EDML_EDM_SHIFT - 1)) + 1) >> 1;
    return rounded < limit ? rounded : limit;
}

/* Q12, counted from about the middle of its range, so that the sum of two has 16 bits; the first layer's
 * biases make up for that.  -14336 to 16145. */
static inline int32_t soften(int32_t distance, int32_t softening)
{
    const int32_t sum = distance + softening;
    return (distance * distance + sum / 2) / sum - EDML_INPUT_ZERO_POINT;
}

/* A row's sum, 0 to 2^31 - 1, times multiplier / 2^shift, to the nearest, at most `clamp`.  multiplier is
 * 1 to 2^31 - 1, so that the product is below 2^62; shift is 1 to 62. */
static inline int32_t requantise(int32_t sum, const dense_layer *layer, int row)
{
    const uint64_t product = (uint64_t)(uint32_t)sum * (uint32_t)layer->multiplier[row];
    const uint64_t scaled = ((product >> (layer->shift - 1)) + 1) >> 1;
    return scaled < (uint32_t)layer->clamp ? (int32_t)scaled : layer->clamp;
}

static inline int32_t activate(int32_t sum, const dense_layer *layer, int row)
{
    return sum > 0 ? requantise(sum, layer, row) : 0;
}

/* |a|, |b| < 2^30, which the exporter proves; the layer's multiplier halves their sum. */
static inline int32_t mean_output(int32_t a, int32_t b, const dense_layer *layer)
{
    return activate(a + b, layer, 0);
}

#define HASH_MULTIPLIERS(hash, layer, rows)                                                                \
    ((hash) = hash_values(hash, (layer)->multiplier, rows, sizeof *(layer)->multiplier))

#endif
