/* FConn that is equivariant to exchanging left and right, which is not the paper's.
 *
 * Each pair of joints has a mirror pair, the same with left for right, and so has each hidden unit.
 * Where mirror pairs change places in the input they do in the output, whatever the weights: a layer
 * multiplies nothing but the sums of mirror pairs (even) and their differences (odd), each by weights of
 * its own,
 *
 *   first, second = relu(E even + O odd + bias), relu(E even - O odd + bias)
 *
 * Every weight counts for left and for right, and the layers are as wide as those of twice as many
 * weights and multiplications.
 *
 * The network reads d^2 / (d + softening) instead of a distance d.  A distance has a kink where two joints
 * are at the same place in the image, as those of a limb that points at the camera are, and noise makes it
 * longer.
 *
 * A layer's inputs are the even ones, then the odd ones.  A layer of n outputs has 2n units, a multiple of
 * EDML_ROWS but in the last, whose n is 49.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_EQUIVARIANT_H
#define EDML_EQUIVARIANT_H

#include "checksum.h"
#include "dot8.h"

enum { MIRROR_PAIRS = 49 };

/* Pairs of joints and their mirror pairs, as EDML_PAIR numbers them.  The last seven, such as that of the
 * knees, mirror themselves, and have odd weights of zero. */
static const uint8_t mirror_pairs[MIRROR_PAIRS][2] = {
    {1, 4},   {2, 5},   {3, 6},   {7, 10},  {8, 11},  {9, 12},  {13, 16}, {14, 17}, {15, 18}, {19, 22},
    {20, 23}, {21, 24}, {25, 55}, {26, 56}, {28, 37}, {29, 46}, {30, 60}, {31, 61}, {32, 62}, {33, 57},
    {34, 58}, {35, 59}, {36, 63}, {39, 47}, {40, 67}, {41, 68}, {42, 69}, {43, 64}, {44, 65}, {45, 66},
    {49, 73}, {50, 74}, {51, 75}, {52, 70}, {53, 71}, {54, 72}, {76, 88}, {77, 89}, {79, 82}, {80, 85},
    {81, 90}, {84, 86}, {0, 0},   {27, 27}, {38, 38}, {48, 48}, {78, 78}, {83, 83}, {87, 87},
};

static const value no_bias[EDML_ROWS] = {0};

static value soft_input(value distance) { return soften(network_input(distance), EDML_SOFTENING); }

/* x: `count` first units, then their mirror units; replaced by their sums and their differences. */
static void split_even_odd(value *x, int count)
{
    for (int k = 0; k < count; k++) {
        const value first = x[k], second = x[count + k];
        x[k] = first + second;
        x[count + k] = first - second;
    }
}

/* Units of a layer, `count` first ones and then their mirror units, from `even` even inputs and then the
 * odd ones.  Returns count. */
static int equivariant_units(value *y, const value *x, int even, const dense_layer *layer)
{
    const int count = (layer->outputs + EDML_ROWS - 1) / EDML_ROWS * EDML_ROWS;
    const weight *w = layer->weight;
    for (int row = 0; row < count; row += EDML_ROWS, w += EDML_ROWS * layer->inputs) {
        value from_even[EDML_ROWS], from_odd[EDML_ROWS];
        dot8(from_even, x, w, layer->bias + row, even);
        dot8(from_odd, x + even, w + EDML_ROWS * even, no_bias, layer->inputs - even);
        for (int k = 0; k < EDML_ROWS; k++) {
            y[row + k] = activate(from_even[k] + from_odd[k], layer, row + k);
            y[count + row + k] = activate(from_even[k] - from_odd[k], layer, row + k);
        }
    }
    return count;
}

/* `in` may be the first units, and `out` may be `in` where that is not. */
EDML_INTERNAL void WEIGHTS(edml__equivariant)(value *out, const value *in, const edml_model *model,
                                              void *scratch)
{
    value(*units)[EDML_MAX_UNITS] = scratch;
    const dense_layer *layers = model->layers;
    value *x = units[1];
    int count = MIRROR_PAIRS;
    for (int k = 0; k < MIRROR_PAIRS; k++) {
        x[k] = soft_input(in[mirror_pairs[k][0]]);
        x[MIRROR_PAIRS + k] = soft_input(in[mirror_pairs[k][1]]);
    }
    for (int n = 0; n < model->layer_count; n++) {
        value *y = units[n & 1];
        split_even_odd(x, count);
        /* the first layer does not read the zeros behind its inputs */
        count = equivariant_units(y, x, count, &layers[n]);
        x = y;
    }
    for (int k = 0; k < MIRROR_PAIRS; k++) {
        out[mirror_pairs[k][0]] = x[k];
        out[mirror_pairs[k][1]] = x[count + k];
    }
}

EDML_INTERNAL uint32_t WEIGHTS(edml__equivariant_checksum)(const edml_model *model)
{
    return hash_layers(model->layers, model->layer_count);
}

#endif
