/* The inputs of a layer that are not zero, for kernels that leave the others out.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_ROWS_SOME_INPUTS_H
#define EDML_ROWS_SOME_INPUTS_H

#include "layer_inputs.h"

enum { LAST_OF_LIST = 255, LISTED = EDML_MAX_UNITS + 2, LIST_IN_PLACE = 0 };

/* Moves those of x from `from` to before `to` forward, and lists where they were; returns how many there are.
 * Where processors predict branches, none depends on an input, so that none is mispredicted. */
static int list_part(activation *kept, uint8_t *list, const activation *x, int from, int to)
{
    const activation *const first = kept;
    for (int i = from; i < to; i++) {
        const activation xi = x[i];
        if (SKIPS_ZEROS && xi == 0) continue;
        *list = (uint8_t)i;
        *kept = xi;
        list += xi != 0;
        kept += xi != 0;
    }
    *list = LAST_OF_LIST;
    return (int)(kept - first);
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
