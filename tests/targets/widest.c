/* Runs the widest network that work memory holds, and compares it with its definition: on a processor that lists what a
 * layer reads, the list then fills its memory.  Prints, for each kind of weights, how many values are as defined.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>
#include <string.h>

#include "edmlift/fixed.h"
#include "network/kernels.h"

EDML_KERNEL(equivariant, w16);
EDML_KERNEL(equivariant, w8);

enum { HALF = EDML_MAX_UNITS / 2, LAYERS = 2, RUNS = 4, MOST_UNIT = 16383, CLAMP = 3 << 16 };

static edml_work_q work;
static EDML_ALIGN4 int16_t w16[LAYERS][HALF * EDML_MAX_UNITS];
static EDML_ALIGN4 int8_t w8[LAYERS][HALF * EDML_MAX_UNITS];
static int8_t plain[LAYERS][HALF][EDML_MAX_UNITS];
static int32_t bias[LAYERS][HALF], multiplier[LAYERS][HALF];

static int draw(int range)
{
    static uint32_t state = 1;
    state = state * 1664525U + 1013904223U;
    return (int)((state >> 8) % (uint32_t)range);
}

/* Weights of up to 31.  With `offset` all units fire. */
static void draw_layer(int n, int32_t offset)
{
    for (int row = 0; row < HALF; row++) {
        for (int k = 0; k < EDML_MAX_UNITS; k++) {
            plain[n][row][k] = (int8_t)(draw(63) - 31);
            w16[n][edml__place(row, k, EDML_MAX_UNITS, 2)] = plain[n][row][k];
            w8[n][edml__place(row, k, EDML_MAX_UNITS, 1)] = plain[n][row][k];
        }
        bias[n][row] = offset;
        multiplier[n][row] = n == 0 ? 1 << 17 : 1 << 27; /* some outputs are clamped */
    }
}

static int32_t limited(int32_t x, int32_t least, int32_t most)
{
    return x < least ? least : x > most ? most : x;
}

static int32_t scaled(int64_t sum, int32_t by)
{
    return (int32_t)((sum * by + (INT64_C(1) << 31)) >> 32);
}

/* x: even inputs, then odd ones; becomes the next layer's, or what the network gives. */
static void run_defined(int32_t x[EDML_MAX_UNITS], int n)
{
    int32_t y[EDML_MAX_UNITS];
    for (int row = 0; row < HALF; row++) {
        int64_t even = bias[n][row], odd = 0;
        for (int k = 0; k < HALF; k++) {
            even += plain[n][row][k] * x[k];
            odd += plain[n][row][HALF + k] * x[HALF + k];
        }
        const int32_t sum = scaled(even + odd, multiplier[n][row]), rest = scaled(even - odd, multiplier[n][row]);
        const int32_t unit = limited(sum, 0, MOST_UNIT), mirror_unit = limited(rest, 0, MOST_UNIT);
        y[row] = n == 0 ? unit + mirror_unit : limited(sum, -CLAMP, CLAMP) * 256;
        y[HALF + row] = n == 0 ? unit - mirror_unit : limited(rest, -CLAMP, CLAMP) * 256;
    }
    memcpy(x, y, sizeof y);
}

/* share: of the inputs that are not zero, in quarters. */
static int run(void (*predict)(int32_t *, const int32_t *, const edml_model *, void *), const void *layers,
               int share)
{
    edml_model model;
    int32_t wanted[EDML_MAX_UNITS], *const values = work.of.network.io.values;
    memset(&model, 0, sizeof model);
    model.layers = layers;
    model.layer_count = LAYERS;
    model.inputs = EDML_MAX_UNITS;
    model.even_inputs = model.outputs = HALF;
    for (int k = 0; k < EDML_MAX_UNITS; k++) {
        wanted[k] = draw(4) < share ? draw(32767) + 1 : 0;
        values[k] = wanted[k] * 4096;
    }
    for (int n = 0; n < LAYERS; n++) run_defined(wanted, n);
    predict(values, values, &model, &work.of.network.units);
    int same = 0;
    for (int k = 0; k < EDML_MAX_UNITS; k++) same += values[k] == wanted[k];
    return same;
}

int main(void)
{
    edml_dense_w16 wide[LAYERS];
    edml_dense_w8 narrow[LAYERS];
    int same_w16 = 0, same_w8 = 0;
    for (int n = 0; n < LAYERS; n++) {
        const int32_t clamp = n == 0 ? MOST_UNIT : CLAMP;
        const edml_dense_w16 layer = {EDML_MAX_UNITS, HALF, w16[n], bias[n], multiplier[n], 32, clamp};
        const edml_dense_w8 bytes = {EDML_MAX_UNITS, HALF, w8[n], bias[n], multiplier[n], 32, clamp};
        wide[n] = layer;
        narrow[n] = bytes;
    }
    for (int share = 4; share > 4 - RUNS; share--) { /* from all inputs and units to few of them */
        draw_layer(0, share == 4 ? 1 << 28 : 0);
        draw_layer(1, 0);
        same_w16 += run(edml__equivariant_w16, wide, share);
        same_w8 += run(edml__equivariant_w8, narrow, share);
    }
    printf("w16 %d of %d, w8 %d of %d\n", same_w16, RUNS * EDML_MAX_UNITS, same_w8, RUNS * EDML_MAX_UNITS);
    return 0;
}
