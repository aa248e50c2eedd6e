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
typedef int16_t activation;

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
    return edml__round_to_16_bits(number, EDML_INPUT_SHIFT);
}

/* A row's sum behind the ReLU, times multiplier / 2^32, to the nearest, below 2^bits. */
static EDML_INLINE int32_t activate(int32_t sum, const dense_layer *layer, int row, int bits)
{
    return edml__saturate(edml__high_product(sum, layer->multiplier[row]), bits);
}

/* Of the last layer: the exporter proves that |sum| 2^(32 - shift) is below 2^31. */
static EDML_INLINE int32_t scale_output(int32_t sum, const dense_layer *layer, int row)
{
    return edml__high_product(sum * (INT32_C(1) << (32 - layer->shift)), layer->multiplier[row]);
}

/* In Q24, as signed_output() and mean_output(). */
static inline int32_t output(int32_t sum, const dense_layer *layer, int row)
{
    const int32_t scaled = scale_output(sum > 0 ? sum : 0, layer, row);
    return (scaled < layer->clamp ? scaled : layer->clamp) * (1 << EDML_OUTPUT_SHIFT);
}

static EDML_INLINE int32_t signed_output(int32_t sum, const dense_layer *layer, int row)
{
    const int32_t scaled = scale_output(sum, layer, row), most = layer->clamp;
    return (scaled > most ? most : scaled < -most ? -most : scaled) * (1 << EDML_OUTPUT_SHIFT);
}

/* |a|, |b| < 2^30, which the exporter proves; the layer's multiplier halves their sum. */
static inline int32_t mean_output(int32_t a, int32_t b, const dense_layer *layer)
{
    return output(a + b, layer, 0);
}

enum { CHUNK = EDML_CHUNK, OWN_LIST = 0 };
#define OTHER_UNITS(scratch, out) ((activation *)(scratch) + EDML_MAX_UNITS)
#define SKIPS_ZEROS 1
#if defined(EDML_BLOCKS_BY_PAIR)
#define SUM_ROWS "rows_dsp.h"
#define UNITS "units_dsp.h"
#define ENDS "ends_dsp.h"
#elif !defined(EDML_BLOCKS_BY_ROW)
#define SUM_ROWS "rows_listed.h"
#elif defined(__ARM_FEATURE_MVE) && defined(__GNUC__) && !defined(__ARM_BIG_ENDIAN)
#define SUM_ROWS "rows_mve.h"
#define UNITS "units_mve.h"
#define ENDS "ends_mve.h"
#elif defined(__SSE2__) || defined(__wasm_simd128__)
#define SUM_ROWS "rows_i16x8.h"
#else
#define SUM_ROWS "rows_by_row.h"
#endif

#if defined(__ARM_ARCH_6M__) && defined(__GNUC__) && !defined(__ARM_BIG_ENDIAN)
#define ADD_LISTED "rows_listed_v6m.h"
#elif defined(__ARM_ARCH_7M__) && defined(__GNUC__) && !defined(__ARM_BIG_ENDIAN)
#define ADD_LISTED "rows_listed_v7m.h"
#endif

#ifndef UNITS
#define UNITS "units_by_row.h"
#endif
#ifndef ENDS
#define ENDS "ends_by_value.h"
#endif

#if defined(EDML_BLOCKS_BY_PAIR)
#define DOT8 "dot8_dsp.h"
#elif defined(EDML_BLOCKS_BY_ROW)
#define DOT8 "dot8_by_blocks.h"
#endif

#define HASH_MULTIPLIERS(hash, layer, rows)                                                                \
    ((hash) = hash_values(hash, (layer)->multiplier, rows, sizeof *(layer)->multiplier))

#endif
