/* Networks in float32.  The words of the networks' texts:
 *
 *   WEIGHTS(name)      the name for these weights
 *   value, activation  what sums are made of; what a layer reads
 *   weight             one of dense_layer's, which is a layer of these weights
 *   OTHER_UNITS        where the units of every second layer are
 *   CHUNK              inputs of a layer are filled up to a multiple
 *   OWN_LIST           does a list of inputs need memory of its own?  Else it is where no unit is: where the
 *                      network's outputs come, and for the last layer where units of another would be, or,
 *                      with LIST_IN_PLACE, where its inputs are and behind them
 *   SUM_ROWS           the header that has sum_rows() of rows.h
 *   UNITS              the header that has activate_rows() of units_by_row.h
 *   ENDS               the header that has read_inputs() and give_rows() of ends_by_value.h
 *   network_input()    a distance of the EDM, as the network reads it
 *   signed_input()     a number within +-8, as the network reads it
 *   activate()         what a row's sum becomes behind the ReLU: in integers, of so many bits
 *   output()           the same in the last layer
 *   signed_output()    what a row's sum becomes without a ReLU
 *   mean_output()      the mean of two sums of the last layer, behind the ReLU
 *   DOT8               the header that has dot8(), where the processor has its own
 *   ADD_LISTED         the header that has add_listed() of rows_listed.h, where the processor has its own
 *   SKIPS_ZEROS        is it worth while to compare each input with zero, as half of them are?
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_WEIGHTS_H
#define EDML_WEIGHTS_H

#include "../number/real_f32.h"
#include "model.h"

#define WEIGHTS(name) name##_f32
typedef float value;
typedef float activation;
typedef float weight;
typedef edml_dense_f32 dense_layer;

static inline float network_input(float distance) { return distance; }

static inline float signed_input(float number) { return number; }

static inline float activate(float sum, const dense_layer *layer, int row, int bits)
{
    (void)layer, (void)row, (void)bits;
    return sum > 0 ? sum : 0;
}

static inline float output(float sum, const dense_layer *layer, int row)
{
    return activate(sum, layer, row, 0);
}

static inline float signed_output(float sum, const dense_layer *layer, int row)
{
    (void)layer, (void)row;
    return sum;
}

static inline float mean_output(float a, float b, const dense_layer *layer)
{
    (void)layer;
    return a + b > 0 ? (a + b) * 0.5F : 0;
}

#define HASH_MULTIPLIERS(hash, layer, rows) (void)0

enum { CHUNK = 1, OWN_LIST = 1 };
#define OTHER_UNITS(scratch, out) (out)
#if defined(__GNUC__) && (defined(__SSE2__) || defined(__aarch64__) || defined(__wasm_simd128__))
#define SUM_ROWS "rows_vector.h"
#define SKIPS_ZEROS 0
#elif defined(__GNUC__) && defined(__ARM_FP) && defined(__thumb2__)
#define SUM_ROWS "rows_vfp.h"
#define UNITS "units_vfp.h"
#define ENDS "ends_vfp.h"
#define DOT8 "dot8_vfp.h"
#else
#define SUM_ROWS "rows_by_input.h"
#define SKIPS_ZEROS 1
#endif

#ifndef UNITS
#define UNITS "units_by_row.h"
#define ENDS "ends_by_value.h"
#endif

#endif
