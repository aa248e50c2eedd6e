/* sum_rows(): the sums of some rows of a fully connected layer.
 *
 *   sum   [0] bias and even inputs; [1] odd inputs
 *   x     [even + odd], as a layer's units are kept: unit k at SLOT(k)
 *   w     WEIGHTS_OF(layer, row), of ROWS rows, of which `row` is the first
 *   even, odd  multiples of CHUNK; even > 0; if odd is 0, sum[1] means nothing
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_ROWS_H
#define EDML_ROWS_H

#include "weights.h"

#include SUM_ROWS

#endif
