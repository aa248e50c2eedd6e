/* What twin_q15.c and twin_q7.c share: the vocabulary of twin.inc in whole numbers.  They say NAME,
 * `weight` and `dense_layer` first.
 *
 * Activations are up to half of EDML_ACTIVATION, for the sums of two of them to be 16 bits.  For the
 * same sake what is read of the EDM, in Q12, is counted from about the middle of its range; the first
 * layer's biases make up for that.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_TWIN_INT_H
#define EDML_TWIN_INT_H

#include "net_int.h"

typedef int32_t activation;

static int32_t first_input(int32_t edm)
{
    const int32_t distance = edm_value(edm, EDML_EDM_SHIFT), sum = distance + EDML_SOFT; /* Q12 */
    return (distance * distance + sum / 2) / sum - EDML_MIDDLE; /* -14336 to 16145 */
}

static int32_t activated(int32_t sum, const dense_layer *layer, int row)
{
    return sum > 0 ? rescaled(sum, layer, row) : 0;
}

#endif
