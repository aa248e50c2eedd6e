/* rows.h for weights that lie input by input: eight rows.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_ROWS_BY_INPUT_H
#define EDML_ROWS_BY_INPUT_H

#include "rows_all_inputs.h"
#include "dot8.h"

enum { ROWS = EDML_ROWS };

static void sum_rows(value sum[2][ROWS], const layer_inputs *in, const weight *w, const value *bias,
                     int rows)
{
    static const value none[ROWS] = {0};
    (void)rows;
    dot8(sum[0], in->x, w, bias, in->even);
    if (in->odd > 0) dot8(sum[1], in->x + in->even, w + ROWS * in->even, none, in->odd);
}

#endif
