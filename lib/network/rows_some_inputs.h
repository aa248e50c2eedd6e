/* The inputs of a layer that are not zero, for kernels that leave the others out.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_ROWS_SOME_INPUTS_H
#define EDML_ROWS_SOME_INPUTS_H

#include "layer_inputs.h"

enum { LAST_OF_LIST = 255, LISTED = EDML_MAX_UNITS + 2 };

/* Moves those of x from `from` to before `to` forward, and lists where they were; returns how many there are.  No branch
 * depends on them, so that none is mispredicted. */
static int list_part(activation *kept, uint8_t *list, const activation *x, int from, int to)
{
    int count = 0;
    for (int i = from; i < to; i++) {
        const activation xi = x[i];
        list[count] = (uint8_t)i;
        kept[count] = xi;
        count += xi != 0;
    }
    list[count] = LAST_OF_LIST;
    return count;
}

/* Moves them forward in x, the even ones first, and counts them; list: where each was, and LAST_OF_LIST behind the
 * even ones and behind the odd ones. */
static void list_inputs(layer_inputs *in, activation *x, uint8_t list[LISTED])
{
    const int even = list_part(x, list, x, 0, in->even);
    in->odd = list_part(x + even, list + even + 1, x, in->even, in->inputs);
    in->even = even;
    in->list = list;
}

#endif
