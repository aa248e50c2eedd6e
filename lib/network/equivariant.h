/* A fully connected network that is equivariant to exchanging left and right.
 *
 * Each unit has a mirror unit.  If what the network reads is mirrored, mirror units change places, whatever
 * the weights: a layer multiplies nothing but the sums of mirror units (even) and their differences (odd),
 * each by weights of its own,
 *
 *   first, second = relu(E even + O odd + bias), relu(E even - O odd + bias)
 *
 * Every weight counts for left and for right, and the layers are as wide as those of twice as many weights
 * and multiplications.  The last layer has no ReLU.  lift/inputs.h says what is read and given.
 *
 * A layer's inputs are the even ones, then the odd ones, each filled up to a multiple of CHUNK.  A layer of n
 * outputs has 2n units, the first ones and then their mirror units; n is a multiple of EDML_ROWS, and in the
 * last layer filled up to one.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_EQUIVARIANT_H
#define EDML_EQUIVARIANT_H

#include "checksum.h"
#include "rows.h"

#include ENDS
#include UNITS

/* [0] what even inputs, [1] what odd ones add to the sums of rows, the first of them `row`: their sum is that
 * of a row, their difference that of its mirror row. */
static void sum_parts(value sum[2][ROWS], const layer_inputs *in, const dense_layer *layer, int row,
                      int rows)
{
    sum_rows(sum, in, layer->weight + row * layer->inputs, layer->bias + row, rows);
}

static void activate_layer(activation *y, const layer_inputs *in, const dense_layer *layer, int count)
{
    for (int row = 0; row < count; row += ROWS) {
        const int rows = rows_from(row, count);
        value sum[2][ROWS];
        sum_parts(sum, in, layer, row, rows);
        activate_rows(y + row, sum, layer, row, rows, count);
    }
}

/* `out` may be `in`, and holds EDML_MAX_VALUES.  Layers write to scratch and to OTHER_UNITS in turn, so that the
 * last one reads the scratch. */
EDML_INTERNAL void WEIGHTS(edml__equivariant)(value *out, const value *in, const edml_model *model,
                                              void *scratch)
{
    const dense_layer *layer = (const dense_layer *)model->layers;
    activation *x = (activation *)scratch, *y = OTHER_UNITS(scratch, out);
    uint8_t own_list[OWN_LIST ? LISTED : 1];
    if (model->layer_count % 2 == 0) swap_units(&x, &y);
    int even = read_inputs(x, in, model->even_inputs);
    (void)read_inputs(x + even, in + model->even_inputs, model->inputs - model->even_inputs);
    for (int n = 1; n < model->layer_count; n++, layer++) {
        const int count = EDML_ROWS * EDML_GROUPS(layer->outputs);
        const layer_inputs read = take_inputs(x, even, layer, OWN_LIST ? own_list : (uint8_t *)out);
        activate_layer(y, &read, layer, count);
        even = count;
        swap_units(&x, &y);
    }
    const int count = EDML_ROWS * EDML_GROUPS(layer->outputs);
    uint8_t *const list = OWN_LIST ? own_list : (uint8_t *)(LIST_IN_PLACE ? x : y);
    const layer_inputs read = take_inputs(x, even, layer, list);
    for (int row = 0; row < count; row += ROWS) {
        const int rows = rows_from(row, count);
        value sum[2][ROWS];
        sum_parts(sum, &read, layer, row, rows);
        give_rows(out + row, sum, layer, row, rows, count);
    }
}

EDML_INTERNAL uint32_t WEIGHTS(edml__equivariant_checksum)(const edml_model *model)
{
    return hash_layers((const dense_layer *)model->layers, model->layer_count, CHUNK);
}

#endif
