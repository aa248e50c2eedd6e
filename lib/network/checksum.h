/* The checksum of a network's arrays: FNV-1a over those of each layer, in the order of its members.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_CHECKSUM_H
#define EDML_CHECKSUM_H

#include <stddef.h>

#include "weights.h"

/* Over the bytes of each value, the lowest first on every machine; sizes are 1, 2 or 4. */
static uint32_t hash_values(uint32_t hash, const void *values, uint32_t count, size_t size)
{
    static const uint16_t one = 1;
    const size_t flip = *(const uint8_t *)&one == 1 ? 0 : size - 1;
    const uint8_t *byte = values;
    for (size_t n = 0; n < count * size; n++) hash = (hash ^ byte[n ^ flip]) * 16777619U;
    return hash;
}

static uint32_t hash_layers(const dense_layer *layer, int count)
{
    uint32_t hash = 2166136261U;
    for (int n = 0; n < count; n++, layer++) {
        const uint32_t rows = (layer->outputs + EDML_ROWS - 1U) / EDML_ROWS * EDML_ROWS;
        hash = hash_values(hash, layer->weight, rows * layer->inputs, sizeof *layer->weight);
        hash = hash_values(hash, layer->bias, rows, sizeof *layer->bias);
        HASH_MULTIPLIERS(hash, layer, rows);
    }
    return hash;
}

#endif
