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

/* inputs: a multiple of CHUNK. */
static void dot8(value y[EDML_ROWS], const activation *x, const weight *w, const value *b, int inputs)
{
    const layer_inputs in = {x, inputs, 0, inputs, NULL};
    value sum[2][ROWS];
    sum_rows(sum, &in, w, b, EDML_ROWS);
    for (int row = 0; row < EDML_ROWS; row++) y[row] = sum[0][row];
}

#endif
