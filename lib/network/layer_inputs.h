/* What a layer reads: the argument of sum_rows() of rows.h.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_LAYER_INPUTS_H
#define EDML_LAYER_INPUTS_H

#include "weights.h"

/* rows_mve.h reads the first three members. */
typedef struct {
    const activation *x; /* [even + odd]; rows_dsp.h may have overwritten it */
    int even, odd;       /* multiples of CHUNK, but where zeros are left out */
    int inputs;          /* of the layer, left out or not */
    const uint8_t *list; /* what list_inputs() made, if zeros are left out */
} layer_inputs;

#endif
