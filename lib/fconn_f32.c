/* FConn in float32 (section 3.2): fully connected layers, each followed by a ReLU.
 *
 * SPDX-License-Identifier: MIT
 */
#include <string.h>

#include "model.h"

/* EDML_ROWS outputs at a time, each summed in the order of the inputs: the compiler may use vector
 * instructions, and the bits are the same without them. */
static void dense(float *y, const float *x, const edml_dense_f32 *layer)
{
    const float *weight = layer->weight;
    for (int row = 0; row < layer->outputs; row += EDML_ROWS) {
        float sum[EDML_ROWS];
        memcpy(sum, layer->bias + row, sizeof sum);
        for (int i = 0; i < layer->inputs; i++, weight += EDML_ROWS) {
            if (x[i] == 0.0F) continue; /* half of the hidden units, usually */
            for (int k = 0; k < EDML_ROWS; k++) sum[k] += weight[k] * x[i];
        }
        for (int k = 0; k < EDML_ROWS; k++) y[row + k] = sum[k] > 0.0F ? sum[k] : 0.0F;
    }
}

void edml__fconn_f32(float *distance, const float *edm, const edml_model *model, edml_work *work)
{
    const edml_dense_f32 *layer = model->layers;
    const float *x = edm; /* may be layer[0] of the work memory */
    for (int n = 0; n < model->layer_count; n++) {
        float *y = work->use.layer[(n + 1) & 1];
        dense(y, x, &layer[n]);
        x = y;
    }
    memcpy(distance, x, EDML_PAIRS * sizeof *distance);
}

static uint32_t hash_words(uint32_t hash, const float *values, int count)
{
    for (int i = 0; i < count; i++) {
        uint32_t word;
        memcpy(&word, &values[i], sizeof word);
        hash = (hash ^ word) * 16777619U;
    }
    return hash;
}

uint32_t edml__fconn_hash_f32(const edml_model *model)
{
    const edml_dense_f32 *layer = model->layers;
    uint32_t hash = 2166136261U;
    for (int n = 0; n < model->layer_count; n++) {
        const int rows = (layer[n].outputs + EDML_ROWS - 1) / EDML_ROWS * EDML_ROWS;
        hash = hash_words(hash, layer[n].weight, rows * layer[n].inputs);
        hash = hash_words(hash, layer[n].bias, rows);
    }
    return hash;
}
