/* FConn (section 3.2): fully connected layers, each followed by a ReLU.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_FCONN_H
#define EDML_FCONN_H

#include "checksum.h"
#include "rows.h"

/* Sums of rows, the first of them `row`, and how many. */
static int sum_all(value sum[2][ROWS], const layer_inputs *in, const dense_layer *layer, int row)
{
    const int rows = rows_from(row, EDML_ROWS * EDML_GROUPS(layer->outputs));
    sum_rows(sum, in, layer->weight + row * layer->inputs, layer->bias + row, rows);
    return rows;
}

static void dense_units(activation *y, const layer_inputs *in, const dense_layer *layer)
{
    for (int row = 0; row < layer->outputs; row += ROWS) {
        value sum[2][ROWS];
        const int rows = sum_all(sum, in, layer, row);
        for (int k = 0; k < rows; k++)
            y[row + k] = (activation)activate(sum[0][k], layer, row + k, EDML_UNIT_BITS);
    }
}

/* As edml__equivariant_...(). */
EDML_INTERNAL void WEIGHTS(edml__fconn)(value *out, const value *in, const edml_model *model, void *scratch)
{
    const dense_layer *layer = (const dense_layer *)model->layers;
    activation *x = (activation *)scratch, *y = OTHER_UNITS(scratch, out);
    uint8_t own_list[OWN_LIST ? LISTED : 1];
    if (model->layer_count % 2 == 0) swap_units(&x, &y);
    for (int k = 0; k < layer->inputs; k++)
        x[k] = k < EDML_PAIRS ? (activation)network_input(in[k]) : 0;
    for (int n = 1; n < model->layer_count; n++, layer++) {
        const layer_inputs read = take_inputs(x, layer->inputs, layer,
                                              OWN_LIST ? own_list : (uint8_t *)out);
        dense_units(y, &read, layer);
        for (int k = layer->outputs; k < layer[1].inputs; k++) y[k] = 0; /* what is filled up */
        swap_units(&x, &y);
    }
    uint8_t *const list = OWN_LIST ? own_list : (uint8_t *)(LIST_IN_PLACE ? x : y);
    const layer_inputs read = take_inputs(x, layer->inputs, layer, list);
    for (int row = 0; row < EDML_PAIRS; row += ROWS) {
        value sum[2][ROWS];
        const int rows = sum_all(sum, &read, layer, row);
        for (int k = 0; k < rows; k++) out[row + k] = output(sum[0][k], layer, row + k);
    }
}

EDML_INTERNAL uint32_t WEIGHTS(edml__fconn_checksum)(const edml_model *model)
{
    return hash_layers((const dense_layer *)model->layers, model->layer_count, CHUNK);
}

#endif
