/* rows.h for blocks by row, in portable C.  Sums of integers have no order: rows_dsp.h and rows_mve.h have the
 * same bits.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_ROWS_BY_ROW_H
#define EDML_ROWS_BY_ROW_H

#include "rows_all_inputs.h"

enum { ROWS = EDML_ROWS };

static void add_blocks(value sum[ROWS], const activation *x, const weight *w, int inputs)
{
    for (int chunk = 0; chunk < inputs; chunk += EDML_CHUNK) {
        for (int row = 0; row < ROWS; row++, w += EDML_CHUNK) {
            value of_row = 0;
            for (int k = 0; k < EDML_CHUNK; k++) of_row += x[chunk + k] * w[k];
            sum[row] += of_row;
        }
    }
}

static EDML_NOINLINE void sum_rows(value sum[2][ROWS], const layer_inputs *in, const weight *w,
                                   const value *bias, int rows)
{
    (void)rows;
    for (int row = 0; row < ROWS; row++) {
        sum[0][row] = bias[row];
        sum[1][row] = 0;
    }
    add_blocks(sum[0], in->x, w, in->even);
    add_blocks(sum[1], in->x + in->even, w + ROWS * in->even, in->odd);
}

#endif
