/* A small FConv, of 8 and 16 channels, in float and the same one in integers.  Its weights are drawn,
 * so that tests/vectors/make_fconv_vectors.py can draw them as well.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_TEST_FCONV_TINY_H
#define EDML_TEST_FCONV_TINY_H

#include "network/kernels.h"

EDML_KERNEL(fconv, f32);
EDML_KERNEL(fconv, w8);

enum { TINY_LAYERS = 5, TINY_MAX_WEIGHTS = 49 * 16 * 16 };

static int8_t tiny_weight[TINY_LAYERS][TINY_MAX_WEIGHTS]; /* inputs filled up to whole blocks */
static float tiny_weight_f32[TINY_LAYERS][TINY_MAX_WEIGHTS];
static int32_t tiny_bias[TINY_LAYERS][16], tiny_multiplier[TINY_LAYERS][16];
static float tiny_bias_f32[TINY_LAYERS][16];
static edml_dense_f32 tiny_layers_f32[TINY_LAYERS];
static edml_dense_w8 tiny_layers_w8[TINY_LAYERS];

static int tiny_draw(uint32_t *state) /* -127 to 127 */
{
    *state = *state * 1664525U + 1013904223U;
    return (int)((*state >> 16) % 255) - 127;
}

/* A layer whose weights are multiples of 2^-scale.  Activations are in Q12, so that in integers a
 * sum is in Q(12 + scale). */
static void tiny_layer(int n, int inputs, int outputs, int scale, uint32_t *state)
{
    const int rows = (outputs + EDML_ROWS - 1) / EDML_ROWS * EDML_ROWS, last = n == 4;
    const int filled = (inputs + EDML_CHUNK - 1) / EDML_CHUNK * EDML_CHUNK;
    for (int k = 0; k < rows * inputs; k++) {
        const int input = k / EDML_ROWS % inputs, row = k / EDML_ROWS / inputs * EDML_ROWS + k % EDML_ROWS;
        const int drawn = k % EDML_ROWS < outputs ? tiny_draw(state) : 0;
        tiny_weight[n][edml__place(row, input, filled, 1)] = (int8_t)drawn;
        tiny_weight_f32[n][k] = (float)drawn / (float)(1 << scale);
    }
    for (int k = 0; k < rows; k++) {
        tiny_multiplier[n][k] = 1 << (last ? 31 - 13 - scale + 16
                                           : 32 - scale); /* the mean of two, in Q16 */
        tiny_bias[n][k] = k < outputs ? tiny_draw(state) * (1 << (2 + scale)) : 0; /* up to 1/8 */
        if (n == 4 && k == 0) tiny_bias[n][k] = 3 << (10 + scale);                 /* 3/4 m */
        tiny_bias_f32[n][k] = (float)tiny_bias[n][k] / (float)(4096 << scale);
    }
    const edml_dense_f32 f32 = {(uint16_t)inputs, (uint16_t)outputs, tiny_weight_f32[n], tiny_bias_f32[n]};
    const edml_dense_w8 w8 = {(uint16_t)filled,
                              (uint16_t)outputs,
                              tiny_weight[n],
                              tiny_bias[n],
                              tiny_multiplier[n],
                              last ? 31 : 32,
                              last ? 3 << 16 : EDML_ACTIVATION};
    tiny_layers_f32[n] = f32;
    tiny_layers_w8[n] = w8;
}

/* With the limits and mirror weights of the shipped FConn, which is small, because bits.c runs on small cores;
 * without its refinement, which enlarges what rounding does to distances as poor as these. */
static edml_model tiny_model(const void *layers)
{
    uint32_t state = 2017;
    tiny_layer(0, 49, 8, 9, &state);
    tiny_layer(1, 49 * 8, 16, 10, &state);
    tiny_layer(2, 49 * 16, 8, 10, &state);
    tiny_layer(3, 49 * 8, 16, 9, &state);
    tiny_layer(4, 16, 1, 11, &state);
    edml_model model = edml_fconn_f32;
    model.name = "tiny";
    model.predict_f32 = NULL;
    model.layers = layers;
    model.layer_count = TINY_LAYERS;
    model.objective = EDML_STRESS_NONE;
    model.refine_steps = 0;
    model.work_bytes = sizeof(edml_fconv_work);
    return model;
}

static edml_model tiny_f32(void)
{
    edml_model model = tiny_model(tiny_layers_f32);
    model.predict_f32 = edml__fconv_f32;
    model.compute_checksum = edml__fconv_checksum_f32;
    model.checksum = model.compute_checksum(&model);
    return model;
}

static edml_model tiny_w8(void)
{
    edml_model model = tiny_model(tiny_layers_w8);
    model.predict_q = edml__fconv_w8;
    model.compute_checksum = edml__fconv_checksum_w8;
    model.checksum = model.compute_checksum(&model);
    model.work_bytes_q = sizeof(edml_fconv_work_q);
    model.scale_q = edml__scale_and_orient_q;
    return model;
}

#endif
