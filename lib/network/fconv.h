/* FConv (section 3.2): two convolutions of 7x7, each with a ReLU and a pooling of 2x2 behind it, two
 * transposed ones, each with a ReLU, and one of 1x1, whose map is made symmetric.
 *
 *   14x14 -> 7x7 -> 4x4 -> 7x7 -> 14x14 -> 91 distances
 *
 * Maps lie pixel by pixel, a pixel's channels side by side, so that what a pixel of the next map sees of a
 * row of this one is one run of inputs to dot8().  A layer is a fully connected one of such a window: its
 * inputs are [7][7][channels].  The image has one channel, and its windows are copied, because they are filled
 * up to a multiple of CHUNK.  No map before a pooling and none before the last layer is ever whole in memory.
 *
 * A model has FCONV_LAYERS of edml_dense_*: two convolutions, two transposed ones, and 1x1.  They have up
 * to FCONV_CHANNELS outputs, a multiple of EDML_ROWS.  In integers the sums of the last stay within +-2^30,
 * because it scales those of two.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_FCONV_H
#define EDML_FCONV_H

#include "checksum.h"
#include "dot8.h"

enum { FCONV_LAYERS = 5, FCONV_CHANNELS = 64 };

enum { TAPS = 7, SIDE = EDML_JOINTS, WINDOW = (TAPS * TAPS + EDML_CHUNK - 1) / EDML_CHUNK * EDML_CHUNK };

/* A layer and the map that it reads, of `size` x `size` pixels.  `up`: a transposed convolution of
 * stride 2, whose taps lie in the order 6 4 2 0 5 3 1 on each axis: those that an odd pixel sees
 * first, then those that an even one does, in the order of the inputs.  `copy`: NULL, or where its windows
 * are copied, [WINDOW], as those of the image are. */
typedef struct {
    const dense_layer *layer;
    const activation *in;
    int size, up;
    activation *copy;
} convolution;

/* On an axis: the first input that a pixel sees, its tap, and how many. */
typedef struct {
    int input, tap, count;
} window;

static window window_at(const convolution *c, int at)
{
    window seen = {at - TAPS / 2, 0, TAPS};
    if (c->up) { /* 2 input - 3 + tap = at */
        const int odd = at & 1;
        seen.input = at / 2 - 1;
        seen.tap = odd ? 0 : TAPS / 2 + 1;
        seen.count = TAPS / 2 + odd;
    }
    if (seen.input < 0) {
        seen.tap -= seen.input;
        seen.count += seen.input;
        seen.input = 0;
    }
    if (seen.count > c->size - seen.input) seen.count = c->size - seen.input;
    return seen;
}

/* Of the image, outside which there is nothing. */
static void sum_copied(value *sum, const convolution *c, int y, int x)
{
    for (int n = 0; n < c->layer->inputs; n++) {
        const int v = y - TAPS / 2 + n / TAPS, u = x - TAPS / 2 + n % TAPS;
        const int inside = n < TAPS * TAPS && v >= 0 && v < SIDE && u >= 0 && u < SIDE;
        c->copy[n] = inside ? c->in[v * SIDE + u] : 0;
    }
    for (int row = 0; row < c->layer->outputs; row += EDML_ROWS)
        dot8(sum + row, c->copy, c->layer->weight + row * c->layer->inputs, c->layer->bias + row,
             c->layer->inputs);
}

static void sum_window(value *sum, const convolution *c, window down, window across)
{
    const int channels = c->layer->inputs / (TAPS * TAPS), run = across.count * channels;
    const activation *const first = c->in + (down.input * c->size + across.input) * channels;
    const weight *w = c->layer->weight + (down.tap * TAPS + across.tap) * channels * EDML_ROWS;
    for (int row = 0; row < c->layer->outputs; row += EDML_ROWS) {
        const value *start = c->layer->bias + row;
        for (int k = 0; k < down.count; k++, start = sum + row)
            dot8(sum + row, first + k * c->size * channels, w + k * TAPS * channels * EDML_ROWS, start,
                 run);
        w += EDML_ROWS * c->layer->inputs;
    }
}

/* A pixel of what the layer gives before ReLU and pooling. */
static void sum_pixel(value *sum, const convolution *c, int y, int x)
{
    if (c->copy != NULL)
        sum_copied(sum, c, y, x);
    else
        sum_window(sum, c, window_at(c, y), window_at(c, x));
}

/* A pixel of what the layer gives: [outputs] after the ReLU; of a plain convolution the largest of up
 * to 2x2, which at the end of an odd side are fewer. */
static void fconv_pixel(activation *out, const convolution *c, int y, int x, value sum[2][FCONV_CHANNELS])
{
    const int outputs = c->layer->outputs, pool = c->up ? 1 : 2, end = c->up ? SIDE : c->size;
    value *const largest = sum[0];
    for (int v = y * pool; v < y * pool + pool && v < end; v++) {
        for (int u = x * pool; u < x * pool + pool && u < end; u++) {
            const int first = v == y * pool && u == x * pool;
            sum_pixel(first ? largest : sum[1], c, v, u);
            for (int k = 0; k < outputs && !first; k++)
                if (sum[1][k] > largest[k]) largest[k] = sum[1][k];
        }
    }
    for (int k = 0; k < outputs; k++)
        out[k] = (activation)activate(largest[k], c->layer, k, EDML_UNIT_BITS);
}

static void fill_map(activation *out, int side, const convolution *c, value sum[2][FCONV_CHANNELS])
{
    for (int y = 0; y < side; y++)
        for (int x = 0; x < side; x++, out += c->layer->outputs) fconv_pixel(out, c, y, x, sum);
}

/* The symmetric 14x14 matrix, zero on the diagonal. */
static void fill_image(activation *image, const value *edm)
{
    for (int i = 0; i < SIDE; i++) {
        image[i * SIDE + i] = 0;
        for (int j = i + 1; j < SIDE; j++)
            image[i * SIDE + j] = image[j * SIDE + i] = (activation)network_input(*edm++);
    }
}

/* The scratch. */
typedef struct {
    activation wide[7 * 7 * FCONV_CHANNELS], narrow[4 * 4 * FCONV_CHANNELS];
    value sum[2][FCONV_CHANNELS], image[SIDE * SIDE];
} fconv_maps;

typedef char maps_fit_the_fixed_work_memory[sizeof(activation) > 2 ||
                                                    offsetof(edml_work_q, of.network.units) + sizeof(fconv_maps) <=
                                                        sizeof(edml_fconv_work_q)
                                                ? 1
                                                : -1];
typedef char maps_fit_the_work_memory
    [offsetof(edml_work, of.network.units) + sizeof(fconv_maps) <= sizeof(edml_fconv_work) ? 1 : -1];

EDML_INTERNAL void WEIGHTS(edml__fconv)(value *out, const value *in, const edml_model *model, void *scratch)
{
    fconv_maps *maps = (fconv_maps *)scratch;
    const dense_layer *layer = (const dense_layer *)model->layers;
    activation *const behind_image = maps->narrow + SIDE * SIDE;
    const convolution down1 = {layer, maps->narrow, 14, 0, behind_image};
    const convolution down2 = {layer + 1, maps->wide, 7, 0, NULL};
    const convolution up1 = {layer + 2, maps->narrow, 4, 1, NULL};
    const convolution up2 = {layer + 3, maps->wide, 7, 1, NULL};
    fill_image(maps->narrow, in);
    fill_map(maps->wide, 7, &down1, maps->sum);
    fill_map(maps->narrow, 4, &down2, maps->sum);
    fill_map(maps->wide, 7, &up1, maps->sum);

    layer += FCONV_LAYERS - 1;
    for (int n = 0; n < SIDE * SIDE; n++) {
        fconv_pixel(maps->narrow, &up2, n / SIDE, n % SIDE, maps->sum);
        dot8(maps->sum[0], maps->narrow, layer->weight, layer->bias, layer->inputs);
        maps->image[n] = maps->sum[0][0];
    }
    for (int i = 0; i < SIDE; i++)
        for (int j = i + 1; j < SIDE; j++)
            *out++ = mean_output(maps->image[i * SIDE + j], maps->image[j * SIDE + i], layer);
}

EDML_INTERNAL uint32_t WEIGHTS(edml__fconv_checksum)(const edml_model *model)
{
    return hash_layers((const dense_layer *)model->layers, model->layer_count, CHUNK);
}

#endif
