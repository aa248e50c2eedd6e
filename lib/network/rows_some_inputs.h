/* The inputs of a layer that are not zero, for kernels that leave the others out.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_ROWS_SOME_INPUTS_H
#define EDML_ROWS_SOME_INPUTS_H

#include "layer_inputs.h"

enum { LISTED = EDML_MAX_UNITS };

/* Moves them forward in x, the even ones first, and counts them; list: where each was.  No branch depends on
 * them, so that none is mispredicted. */
static void list_inputs(layer_inputs *in, activation *x, uint8_t list[LISTED])
{
    const int evens = in->even;
    int count = 0;
    in->even = 0;
    for (int i = 0; i < in->inputs; i++) {
        const activation xi = x[i];
        list[count] = (uint8_t)i;
        x[count] = xi;
        count += xi != 0;
        if (i < evens) in->even = count;
    }
    in->odd = count - in->even;
    in->list = list;
}

#endif
