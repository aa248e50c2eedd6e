/* FConn (section 3.2): fully connected layers, each followed by a ReLU.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_FCONN_H
#define EDML_FCONN_H

#include <string.h>

#include "checksum.h"
#include "dot8.h"

static void dense_units(value *y, const value *x, const dense_layer *layer)
{
    const weight *w = layer->weight;
    for (int row = 0; row < layer->outputs; row += EDML_ROWS, w += EDML_ROWS * layer->inputs) {
        dot8(y + row, x, w, layer->bias + row, layer->inputs);
        for (int k = row; k < row + EDML_ROWS; k++) y[k] = activate(y[k], layer, k);
    }
}

EDML_INTERNAL void WEIGHTS(edml__fconn)(value *out, const value *in, const edml_model *model, void *scratch)
{
    value(*units)[EDML_MAX_UNITS] = scratch;
    const dense_layer *layers = model->layers;
    value *x = units[0];
    for (int k = 0; k < EDML_PAIRS; k++) x[k] = network_input(in[k]);
    for (int n = 0; n < model->layer_count; n++) {
        value *y = units[(n + 1) & 1];
        dense_units(y, x, &layers[n]);
        x = y;
    }
    memcpy(out, x, EDML_PAIRS * sizeof *out);
}

EDML_INTERNAL uint32_t WEIGHTS(edml__fconn_checksum)(const edml_model *model)
{
    return hash_layers(model->layers, model->layer_count);
}

#endif
