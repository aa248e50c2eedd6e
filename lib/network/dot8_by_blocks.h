/* dot8.h where weights lie in blocks by row: by the processor's sum_rows().
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_DOT8_BY_BLOCKS_H
#define EDML_DOT8_BY_BLOCKS_H

#include <stddef.h>

#include "layer_inputs.h"
#include "weights.h"

#include SUM_ROWS

/* x is kept as units are, unit k at SLOT(k); inputs: a multiple of CHUNK. */
static void dot8(value y[EDML_ROWS], const activation *x, const weight *w, const value *b, int inputs)
{
    const layer_inputs in = {x, inputs, 0, inputs, NULL};
    for (int row = 0; row < EDML_ROWS; row += ROWS) {
        value sum[2][ROWS];
        sum_rows(sum, &in, w + row * EDML_CHUNK, b + row, ROWS);
        for (int k = 0; k < ROWS; k++) y[row + k] = sum[0][k];
    }
}

#endif
