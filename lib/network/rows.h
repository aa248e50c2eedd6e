/* sum_rows(): the sums of some rows of a fully connected layer.
 *
 *   sum   [0] bias and even inputs; [1] odd inputs
 *   x     [even + odd], as a layer's units are kept: unit k at SLOT(k)
 *   w     WEIGHTS_OF(layer, row), of which `row` is the first
 *   rows  ROWS, or what is left of the layer, a multiple of EDML_ROWS
 *   even, odd  multiples of CHUNK; even > 0; if odd is 0, sum[1] means nothing
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_ROWS_H
#define EDML_ROWS_H

#include "weights.h"

#include SUM_ROWS

static void swap_units(activation **x, activation **y)
{
    activation *const was = *x;
    *x = *y;
    *y = was;
}

static int rows_from(int row, int count) { return count - row < ROWS ? count - row : ROWS; }

#endif
