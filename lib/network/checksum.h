/* The checksum of a network's arrays: FNV-1a over those of each layer, in the order of its members, weights
 * input by input.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_CHECKSUM_H
#define EDML_CHECKSUM_H

#include <stddef.h>

#include "weights.h"

/* Over the bytes of a number, the lowest first on every machine; sizes are 1, 2 or 4. */
static uint32_t hash_value(uint32_t hash, const void *item, size_t size)
{
    static const uint16_t one = 1;
    const size_t flip = *(const uint8_t *)&one == 1 ? 0 : size - 1;
    const uint8_t *byte = (const uint8_t *)item;
    uint32_t next = hash;
    for (size_t n = 0; n < size; n++) next = (next ^ byte[n ^ flip]) * 16777619U;
    return next;
}

static uint32_t hash_values(uint32_t hash, const void *values, int count, size_t size)
{
    const uint8_t *item = (const uint8_t *)values;
    for (int n = 0; n < count; n++, item += size) hash = hash_value(hash, item, size);
    return hash;
}

/* Those of eight rows, input by input; chunk: 1, or that of blocks. */
static uint32_t hash_weights(uint32_t hash, const dense_layer *layer, int row, int chunk)
{
    const int inputs = layer->inputs, bytes = (int)sizeof(weight);
    for (int input = 0; input < inputs; input++) {
        for (int r = row; r < row + EDML_ROWS; r++) {
            const int by_input = row * inputs + input * EDML_ROWS + r - row;
            const int place = chunk == 1 ? by_input : edml__place(r, input, inputs, bytes);
            hash = hash_value(hash, layer->weight + place, sizeof(weight));
        }
    }
    return hash;
}

static uint32_t hash_layers(const dense_layer *layer, int count, int chunk)
{
    uint32_t hash = 2166136261U;
    for (int n = 0; n < count; n++, layer++) {
        const int rows = EDML_ROWS * EDML_GROUPS(layer->outputs);
        for (int row = 0; row < rows; row += EDML_ROWS) hash = hash_weights(hash, layer, row, chunk);
        hash = hash_values(hash, layer->bias, rows, sizeof *layer->bias);
        HASH_MULTIPLIERS(hash, layer, rows);
    }
    return hash;
}

#endif
