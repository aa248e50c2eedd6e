/* sum_rows(sum, in, w, bias, rows): the sums of some rows of a fully connected layer.
 *
 *   sum   [0] bias and even inputs; [1] odd inputs
 *   in    in->even > 0, but where zeros are left out; if in->odd is 0, sum[1] means nothing
 *   w     the layer's, from the first of these rows on
 *   rows  ROWS, or what is left of the layer, a multiple of EDML_ROWS
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_ROWS_H
#define EDML_ROWS_H

#include <stddef.h>

#include "layer_inputs.h"
#include "weights.h"

#include SUM_ROWS

/* x: [layer->inputs], the even ones first; list: room for LISTED bytes, apart from x.
 * If LIST_IN_PLACE it may begin where x does, which is lost then. */
static layer_inputs take_inputs(activation *x, int even, const dense_layer *layer, uint8_t *list)
{
    layer_inputs in = {x, even, layer->inputs - even, layer->inputs, NULL};
    list_inputs(&in, x, list);
    return in;
}

static void swap_units(activation **x, activation **y)
{
    activation *const was = *x;
    *x = *y;
    *y = was;
}

/* count: a multiple of EDML_ROWS */
static int rows_from(int row, int count)
{
    return (int)ROWS > EDML_ROWS && count - row < ROWS ? count - row : ROWS;
}

#endif
