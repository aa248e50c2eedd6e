/* activate_rows(): what a layer of an equivariant network makes of the sums of some rows, in portable C.
 *
 *   sum   of `rows` rows, of which `row` is the first: [0] what even inputs, [1] what odd ones add
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_UNITS_BY_ROW_H
#define EDML_UNITS_BY_ROW_H

#include "rows.h"

/* Units and mirror units: y[k] is their sum, which is even, y[count + k] their difference.  Out of line, because
 * sum_parts() leaves no registers. */
static EDML_NOINLINE void activate_rows(activation *y, value sum[2][ROWS], const dense_layer *layer,
                                        int row, int rows, int count)
{
    for (int k = 0; k < rows; k++) {
        const value even = sum[0][k], odd = sum[1][k];
        const value unit = activate(even + odd, layer, row + k, EDML_PAIRED_BITS);
        const value mirror_unit = activate(even - odd, layer, row + k, EDML_PAIRED_BITS);
        y[k] = (activation)(unit + mirror_unit);
        y[count + k] = (activation)(unit - mirror_unit);
    }
}

#endif
