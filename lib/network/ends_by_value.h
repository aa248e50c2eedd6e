/* The first inputs and the last outputs of an equivariant network, in portable C.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_ENDS_BY_VALUE_H
#define EDML_ENDS_BY_VALUE_H

#include "rows.h"

/* Inputs, and zero for those that fill up a chunk; returns how many. */
static int read_inputs(activation *x, const value *in, int inputs)
{
    int k = 0;
    for (; k < inputs; k++) x[k] = (activation)signed_input(in[k]);
    for (; k % CHUNK != 0; k++) x[k] = 0;
    return k;
}

/* What the last layer gives of some rows, and of their mirror rows `count` further on. */
static EDML_NOINLINE void give_rows(value *out, value sum[2][ROWS], const dense_layer *last, int row,
                                    int rows, int count)
{
    const dense_layer layer = *last; /* nothing of which depends on `out` */
    for (int k = 0; k < rows; k++) {
        const value even = sum[0][k], odd = sum[1][k];
        out[k] = signed_output(even + odd, &layer, row + k);
        out[count + k] = signed_output(even - odd, &layer, row + k);
    }
}

#endif
