/* FConn in float32 (section 3.2): fully connected layers, each followed by a ReLU.
 *
 * SPDX-License-Identifier: MIT
 */
#include <string.h>

#include "model.h"

static float relu(float value) { return value > 0.0F ? value : 0.0F; }

/* Eight outputs at a time, in eight registers, each summed in the order of the inputs: the compiler
 * may use vector instructions, and the bits are the same without them. */
static void dense(float *y, const float *x, const edml_dense_f32 *layer)
{
    const float *w = layer->weight, *b = layer->bias;
    for (int row = 0; row < layer->outputs; row += EDML_ROWS, b += EDML_ROWS, y += EDML_ROWS) {
        float s0 = b[0], s1 = b[1], s2 = b[2], s3 = b[3];
        float s4 = b[4], s5 = b[5], s6 = b[6], s7 = b[7];
        for (int i = 0; i < layer->inputs; i++, w += EDML_ROWS) {
            const float xi = x[i];
            if (xi == 0.0F) continue; /* half of the hidden units, usually */
            s0 += w[0] * xi;
            s1 += w[1] * xi;
            s2 += w[2] * xi;
            s3 += w[3] * xi;
            s4 += w[4] * xi;
            s5 += w[5] * xi;
            s6 += w[6] * xi;
            s7 += w[7] * xi;
        }
        y[0] = relu(s0);
        y[1] = relu(s1);
        y[2] = relu(s2);
        y[3] = relu(s3);
        y[4] = relu(s4);
        y[5] = relu(s5);
        y[6] = relu(s6);
        y[7] = relu(s7);
    }
}

void edml__fconn_f32(float distance[EDML_PAIRS], const float edm[EDML_PAIRS],
                     const edml_model *model, float layer[2][EDML_LAYER_WIDEST])
{
    const edml_dense_f32 *dense_layer = model->layers;
    const float *x = edm; /* may be layer[0] */
    for (int n = 0; n < model->layer_count; n++) {
        float *y = layer[(n + 1) & 1];
        dense(y, x, &dense_layer[n]);
        x = y;
    }
    memcpy(distance, x, EDML_PAIRS * sizeof *distance);
}

/* FNV-1a over the bytes of each value, the lowest first on every machine. */
static uint32_t hash_values(uint32_t hash, const float *values, int count)
{
    for (int i = 0; i < count; i++) {
        uint32_t word;
        memcpy(&word, &values[i], sizeof word);
        for (int shift = 0; shift < 32; shift += 8) hash = (hash ^ (word >> shift & 255)) * 16777619U;
    }
    return hash;
}

uint32_t edml__fconn_hash_f32(const edml_model *model)
{
    const edml_dense_f32 *layer = model->layers;
    uint32_t hash = 2166136261U;
    for (int n = 0; n < model->layer_count; n++) {
        const int rows = (layer[n].outputs + EDML_ROWS - 1) / EDML_ROWS * EDML_ROWS;
        hash = hash_values(hash, layer[n].weight, rows * layer[n].inputs);
        hash = hash_values(hash, layer[n].bias, rows);
    }
    return hash;
}
