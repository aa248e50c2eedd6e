/* A small FConv, of 8 and 16 channels, in float and the same one in whole numbers: its weights are drawn,
 * so that tests/make_fconv_vectors.py can draw them, too.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_TEST_FCONV_TINY_H
#define EDML_TEST_FCONV_TINY_H

#include "model.h"

enum { TINY_MOST = 49 * 16 * 16 };

static int8_t tiny_weight[EDML_FCONV_LAYERS][TINY_MOST];
static float tiny_weight_f32[EDML_FCONV_LAYERS][TINY_MOST];
static int32_t tiny_bias[EDML_FCONV_LAYERS][16], tiny_factor[EDML_FCONV_LAYERS][16];
static float tiny_bias_f32[EDML_FCONV_LAYERS][16];
static edml_dense_f32 tiny_layers_f32[EDML_FCONV_LAYERS];
static edml_dense_q7 tiny_layers_q7[EDML_FCONV_LAYERS];

static int tiny_draw(uint32_t *state) /* -127 to 127 */
{
    *state = *state * 1664525U + 1013904223U;
    return (int)((*state >> 16) % 255) - 127;
}

/* A layer whose weights are multiples of 2^-scale.  Activations are in Q12, so that in whole numbers a
 * sum is in Q(12 + scale). */
static void tiny_layer(int n, int inputs, int outputs, int scale, uint32_t *state)
{
    const int rows = (outputs + EDML_ROWS - 1) / EDML_ROWS * EDML_ROWS;
    for (int k = 0; k < rows * inputs; k++) {
        tiny_weight[n][k] = (int8_t)(k % EDML_ROWS < outputs ? tiny_draw(state) : 0);
        tiny_weight_f32[n][k] = (float)tiny_weight[n][k] / (float)(1 << scale);
    }
    for (int k = 0; k < rows; k++) {
        tiny_factor[n][k] = 1 << 20;
        tiny_bias[n][k] = k < outputs ? tiny_draw(state) * (1 << (2 + scale)) : 0; /* up to 1/8 */
        if (n == 4 && k == 0) tiny_bias[n][k] = 3 << (10 + scale);                 /* 3/4 m */
        tiny_bias_f32[n][k] = (float)tiny_bias[n][k] / (float)(4096 << scale);
    }
    const int last = n == 4, shift = last ? 20 + 12 + scale + 1 - 24 : 20 + scale;
    const edml_dense_f32 f32 = {(uint16_t)inputs, (uint16_t)outputs, tiny_weight_f32[n],
                                tiny_bias_f32[n]};
    const edml_dense_q7 q7 = {(uint16_t)inputs, (uint16_t)outputs, tiny_weight[n],
                              tiny_bias[n],     tiny_factor[n],    (uint8_t)shift,
                              last ? 3 << 24 : EDML_ACTIVATION};
    tiny_layers_f32[n] = f32;
    tiny_layers_q7[n] = q7;
}

static const edml_fconv tiny_net_f32 = {edml__fconv_f32, NULL, tiny_layers_f32};
static const edml_fconv tiny_net_q7 = {NULL, edml__fconv_q7, tiny_layers_q7};

static edml_model tiny_model(const edml_fconv *net)
{
    uint32_t state = 2017;
    tiny_layer(0, 49, 8, 9, &state);
    tiny_layer(1, 49 * 8, 16, 10, &state);
    tiny_layer(2, 49 * 16, 8, 10, &state);
    tiny_layer(3, 49 * 8, 16, 9, &state);
    tiny_layer(4, 16, 1, 11, &state);
    edml_model model = edml_fconn_f32; /* its limits and mirror weights */
    model.name = "tiny";
    model.predict_f32 = edml__fconv_refuse;
    model.hash = net == &tiny_net_f32 ? edml__fconv_hash_f32 : edml__fconv_hash_q7;
    model.layers = net;
    model.layer_count = 0;
    model.checksum = model.hash(&model);
    return model;
}

#endif
