/* FConn that treats left and right alike, which is not the paper's; and the checksum of its arrays.
 *
 * A pair of joints has a twin, the same with left for right, and so has each hidden unit.  Where twins
 * change places in the input they do in the output, whatever the weights: a layer multiplies nothing
 * but the sums of twins (even) and their differences (odd), each by weights of its own,
 *
 *   first, second = relu(E even + O odd + bias), relu(E even - O odd + bias)
 *
 * What it reads of a distance d is d^2 / (d + EDML_SOFT): a distance has a kink where two joints are at the
 * same place in the image, as those of a limb that points at the camera, and noise makes it longer.
 *
 * Every weight counts for left and for right, and the layers are as wide as those of twice as many
 * weights and multiplications.
 *
 * `value`, `activation` and `dense_layer` are as in fconn.inc, a layer's inputs the even ones and then
 * the odd ones; first_input() and activated() do what differs.
 *
 * SPDX-License-Identifier: MIT
 */

#define SUMS_ALONE
#ifndef ROWS
#define ROWS "rows.inc"
#endif
#include ROWS

#include "hash.inc"

enum { TWINS = 49 };

/* Pairs of joints and their twins, as EDML_PAIR numbers them; the last seven, such as that of the knees,
 * are their own, and have odd weights of zero. */
static const uint8_t twins[TWINS][2] = {
    {1, 4}, {2, 5}, {3, 6}, {7, 10}, {8, 11}, {9, 12}, {13, 16}, {14, 17}, {15, 18}, {19, 22},
    {20, 23}, {21, 24}, {25, 55}, {26, 56}, {28, 37}, {29, 46}, {30, 60}, {31, 61}, {32, 62},
    {33, 57}, {34, 58}, {35, 59}, {36, 63}, {39, 47}, {40, 67}, {41, 68}, {42, 69}, {43, 64},
    {44, 65}, {45, 66}, {49, 73}, {50, 74}, {51, 75}, {52, 70}, {53, 71}, {54, 72}, {76, 88},
    {77, 89}, {79, 82}, {80, 85}, {81, 90}, {84, 86}, {0, 0}, {27, 27}, {38, 38}, {48, 48},
    {78, 78}, {83, 83}, {87, 87},
};

static const value no_bias[EDML_ROWS] = {0};

/* x: `count` first twins, then the second ones; replaced by their sums and their differences. */
static void mix(value *x, int count)
{
    for (int k = 0; k < count; k++) {
        const value first = x[k], second = x[count + k];
        x[k] = first + second;
        x[count + k] = first - second;
    }
}

/* Units of a layer, `count` first ones and then their twins, from `even` even inputs and then the odd
 * ones.  Returns count. */
static int units(value *y, const value *x, int even, const dense_layer *layer)
{
    const int count = (layer->outputs + EDML_ROWS - 1) / EDML_ROWS * EDML_ROWS;
    const weight *w = layer->weight;
    for (int row = 0; row < count; row += EDML_ROWS, w += EDML_ROWS * layer->inputs) {
        value alike[EDML_ROWS], unlike[EDML_ROWS];
        multiply_rows(alike, x, w, layer->bias + row, even);
        multiply_rows(unlike, x + even, w + EDML_ROWS * even, no_bias, layer->inputs - even);
        for (int k = 0; k < EDML_ROWS; k++) {
            y[row + k] = activated(alike[k] + unlike[k], layer, row + k);
            y[count + row + k] = activated(alike[k] - unlike[k], layer, row + k);
        }
    }
    return count;
}

/* `edm` may be layer[0], and `distance` may be `edm` where that is not. */
void NAME(edml__twin)(value distance[EDML_PAIRS], const value edm[EDML_PAIRS],
                      const edml_model *model, value layer[2][EDML_LAYER_WIDEST])
{
    const dense_layer *layers = model->layers;
    value *x = layer[1];
    int count = TWINS;
    for (int k = 0; k < TWINS; k++) {
        x[k] = first_input(edm[twins[k][0]]);
        x[TWINS + k] = first_input(edm[twins[k][1]]);
    }
    for (int n = 0; n < model->layer_count; n++) {
        value *y = layer[n & 1];
        mix(x, count);
        count = units(y, x, count, &layers[n]); /* the first layer does not read zeros behind its inputs */
        x = y;
    }
    for (int k = 0; k < TWINS; k++) {
        distance[twins[k][0]] = x[k];
        distance[twins[k][1]] = x[count + k];
    }
}

uint32_t NAME(edml__twin_hash)(const edml_model *model)
{
    return hash_layers(model->layers, model->layer_count);
}
