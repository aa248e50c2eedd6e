/* FConn (section 3.2): fully connected layers, each followed by a ReLU; and the checksum of its
 * arrays.
 *
 * `value` is what sums are made of and `activation` what comes out of a layer, `dense_layer` the layer
 * of the format; first_input() and rescale() do what differs, and ROWS may name another rows.inc.
 *
 * SPDX-License-Identifier: MIT
 */

/* Sums of eight rows: multiply_rows(), in portable C or in the processor's own words. */
#ifndef ROWS
#define ROWS "rows.inc"
#endif
#include ROWS

#include "hash.inc"

static void dense(value *y, const value *x, const dense_layer *layer)
{
    const weight *w = layer->weight;
    for (int row = 0; row < layer->outputs; row += EDML_ROWS, w += EDML_ROWS * layer->inputs)
        multiply_rows(y + row, x, w, layer->bias + row, layer->inputs);
}

/* `edm` may be layer[0], and `distance` may be `edm`. */
void NAME(edml__fconn)(value distance[EDML_PAIRS], const value edm[EDML_PAIRS],
                       const edml_model *model, value layer[2][EDML_LAYER_WIDEST])
{
    const dense_layer *layers = model->layers;
    const value *x = first_input(layer[0], edm);
    for (int n = 0; n < model->layer_count; n++) {
        value *y = layer[(n + 1) & 1];
        dense(y, x, &layers[n]);
        rescale(y, &layers[n]);
        x = y;
    }
    memcpy(distance, x, EDML_PAIRS * sizeof *distance);
}

uint32_t NAME(edml__fconn_hash)(const edml_model *model)
{
    return hash_layers(model->layers, model->layer_count);
}
