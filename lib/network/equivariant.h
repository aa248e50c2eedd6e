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
 * A layer's inputs are the even ones, then the odd ones.  A layer of n outputs has 2n units, the first ones and
 * then their mirror units; n is a multiple of EDML_ROWS, and in the last layer filled up to one.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_EQUIVARIANT_H
#define EDML_EQUIVARIANT_H

#include "checksum.h"
#include "dot8.h"

static const value no_bias[EDML_ROWS] = {0};

/* Sums of a layer's rows and, from y[count] on, of their mirror rows: from `even` even inputs, then the odd
 * ones. */
static void sum_rows(value *y, const value *x, int even, const dense_layer *layer, int count)
{
    const weight *w = layer->weight;
    for (int row = 0; row < count; row += EDML_ROWS, w += EDML_ROWS * layer->inputs) {
        value *const first = y + row, *const second = y + count + row;
        value from_odd[EDML_ROWS];
        dot8(first, x, w, layer->bias + row, even);
        dot8(from_odd, x + even, w + EDML_ROWS * even, no_bias, layer->inputs - even);
        for (int k = 0; k < EDML_ROWS; k++) {
            second[k] = first[k] - from_odd[k];
            first[k] = first[k] + from_odd[k];
        }
    }
}

/* Units of the sums; then the sums of a unit and its mirror unit, which are even, and their differences. */
static void activate_units(value *y, const dense_layer *layer, int count)
{
    for (int k = 0; k < count; k++) {
        const value first = activate(y[k], layer, k), second = activate(y[count + k], layer, k);
        y[k] = first + second;
        y[count + k] = first - second;
    }
}

/* `out` may be `in`. */
EDML_INTERNAL void WEIGHTS(edml__equivariant)(value *out, const value *in, const edml_model *model,
                                              void *scratch)
{
    value(*units)[EDML_MAX_UNITS] = scratch;
    const dense_layer *layer = model->layers;
    value *x = units[0], *y = units[1];
    int even = model->even_inputs;
    for (int k = 0; k < model->inputs; k++) x[k] = signed_input(in[k]);
    for (int n = 1; n < model->layer_count; n++, layer++) {
        const int count = EDML_ROWS * EDML_GROUPS(layer->outputs);
        sum_rows(y, x, even, layer, count);
        activate_units(y, layer, count);
        even = count;
        value *const read = x;
        x = y;
        y = read;
    }
    const int count = EDML_ROWS * EDML_GROUPS(layer->outputs);
    sum_rows(out, x, even, layer, count);
    for (int k = 0; k < count; k++) {
        out[k] = signed_output(out[k], layer, k);
        out[count + k] = signed_output(out[count + k], layer, k);
    }
}

EDML_INTERNAL uint32_t WEIGHTS(edml__equivariant_checksum)(const edml_model *model)
{
    return hash_layers(model->layers, model->layer_count);
}

#endif
