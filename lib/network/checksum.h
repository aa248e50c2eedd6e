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

/* Where in its memory a network's weight is that the header has in place n; chunk: 1, or that of blocks. */
static int place_of(int n, int inputs, int chunk)
{
    const int group = n / EDML_ROWS / inputs, input = n / EDML_ROWS % inputs, row = n % EDML_ROWS;
    return chunk == 1 ? n : edml__place(group * EDML_ROWS + row, input, inputs, (int)sizeof(weight));
}

static uint32_t hash_layers(const dense_layer *layer, int count, int chunk)
{
    uint32_t hash = 2166136261U;
    for (int n = 0; n < count; n++, layer++) {
        const int rows = EDML_ROWS * EDML_GROUPS(layer->outputs);
        for (int k = 0; k < rows * layer->inputs; k++)
            hash = hash_value(hash, &layer->weight[place_of(k, layer->inputs, chunk)], sizeof *layer->weight);
        hash = hash_values(hash, layer->bias, rows, sizeof *layer->bias);
        HASH_MULTIPLIERS(hash, layer, rows);
    }
    return hash;
}

#endif
