/* Small equivariant networks whose weights are drawn.  Their parts are one, two and three blocks of inputs, and the
 * first layer has three groups of rows.  Their sums go far beyond what a unit holds, to either side.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_TEST_EQUIVARIANT_SMALL_H
#define EDML_TEST_EQUIVARIANT_SMALL_H

#include <string.h>

#include "network/kernels.h"

EDML_KERNEL(equivariant, f32);
EDML_KERNEL(equivariant, w16);
EDML_KERNEL(equivariant, w8);

enum { SMALL_EVEN = 8, SMALL_INPUTS = 24, SMALL_UNITS = 24, SMALL_ROWS = 16 };
enum { SMALL_WEIGHTS = 2 * SMALL_UNITS * SMALL_UNITS };

static int16_t small_w16[2][SMALL_WEIGHTS];
static int8_t small_w8[2][SMALL_WEIGHTS];
static float small_f32[2][SMALL_WEIGHTS], small_bias_f32[2][SMALL_UNITS];
static int32_t small_bias[2][SMALL_UNITS], small_multiplier[2][SMALL_UNITS];
static edml_dense_f32 small_layers_f32[2];
static edml_dense_w16 small_layers_w16[2];
static edml_dense_w8 small_layers_w8[2];

/* draw: an integer from 0 to below a range.  Sums of 24 inputs of 16 bits, and of 48 units of 15, fit 31 bits. */
static void draw_small_layer(int n, int (*draw)(int range))
{
    const int inputs = n == 0 ? SMALL_INPUTS : 2 * SMALL_UNITS, rows = n == 0 ? SMALL_UNITS : SMALL_ROWS;
    for (int row = 0; row < rows; row++) {
        for (int input = 0; input < inputs; input++) {
            small_w16[n][edml__place(row, input, inputs, 2)] = (int16_t)(draw(2048) - 1024);
            small_w8[n][edml__place(row, input, inputs, 1)] = (int8_t)(draw(255) - 127);
            small_f32[n][row / 8 * 8 * inputs + input * 8 + row % 8] = (float)(draw(2049) - 1024) / 1024.0F;
        }
        small_bias[n][row] = (draw(2048) - 1024) * 4096;
        const int bits = draw(16);
        small_multiplier[n][row] = 1 + draw(1 << 15) * (1 << bits);
        small_bias_f32[n][row] = (float)(draw(2049) - 1024) / 256.0F;
    }
    const edml_dense_f32 f32 = {(uint16_t)inputs, (uint16_t)rows, small_f32[n], small_bias_f32[n]};
    const edml_dense_w16 w16 = {(uint16_t)inputs,    (uint16_t)rows,      small_w16[n],
                                small_bias[n],       small_multiplier[n], 32,
                                n == 0 ? 16383 : 196608};
    const edml_dense_w8 w8 = {w16.inputs,     w16.outputs, small_w8[n], w16.bias,
                              w16.multiplier, w16.shift,   w16.clamp};
    small_layers_f32[n] = f32;
    small_layers_w16[n] = w16;
    small_layers_w8[n] = w8;
}

/* Draws both layers; layers: one of small_layers_... */
static edml_model small_equivariant(const void *layers, int (*draw)(int range))
{
    edml_model model;
    memset(&model, 0, sizeof model);
    model.layers = layers;
    model.layer_count = 2;
    model.inputs = SMALL_INPUTS;
    model.even_inputs = SMALL_EVEN;
    model.outputs = SMALL_ROWS;
    draw_small_layer(0, draw);
    draw_small_layer(1, draw);
    return model;
}

#endif
