/* What fconn_q15.c and fconn_q7.c share: the vocabulary of fconn.inc in whole numbers.  They say
 * NAME, `weight` and `dense_layer` first.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_FCONN_INT_H
#define EDML_FCONN_INT_H

#include <string.h>

#include "net_int.h"

typedef int32_t activation;

static const int32_t *first_input(int32_t *x, const int32_t *edm) /* x may be edm */
{
    for (int k = 0; k < EDML_PAIRS; k++) x[k] = edm_value(edm[k], EDML_EDM_SHIFT);
    return x;
}

static void rescale(int32_t *y, const dense_layer *layer)
{
    for (int row = 0; row < layer->outputs; row++) y[row] = rescaled(y[row], layer, row);
}

#endif
