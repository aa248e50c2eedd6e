/* rows.h in integers for processors that make one product at a time: eight rows, of the inputs that are not zero.
 * They are listed once a layer.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_ROWS_LISTED_H
#define EDML_ROWS_LISTED_H

#include "weights.h"

enum { ROWS = EDML_ROWS };
#define WEIGHTS_OF(layer, row) ((layer)->weight + (row) * (layer)->inputs)

#define SLOT(k) (k)
#include "rows_some_inputs.h"

/* As dot8(), of listed inputs. */
static EDML_NOINLINE void add_listed(value y[EDML_ROWS], const activation *x, const uint8_t *list,
                                     const weight *weights, const value *b, int count)
{
    value s0 = b[0], s1 = b[1], s2 = b[2], s3 = b[3], s4 = b[4], s5 = b[5], s6 = b[6], s7 = b[7];
    for (const activation *const end = x + count; x < end; x++) {
        const weight *const w = weights + EDML_ROWS * *list++;
        const activation xi = *x;
        s0 += (value)w[0] * xi;
        s1 += (value)w[1] * xi;
        s2 += (value)w[2] * xi;
        s3 += (value)w[3] * xi;
        s4 += (value)w[4] * xi;
        s5 += (value)w[5] * xi;
        s6 += (value)w[6] * xi;
        s7 += (value)w[7] * xi;
    }
    y[0] = s0;
    y[1] = s1;
    y[2] = s2;
    y[3] = s3;
    y[4] = s4;
    y[5] = s5;
    y[6] = s6;
    y[7] = s7;
}

static void sum_rows(value sum[2][ROWS], const layer_inputs *in, const weight *w, const value *bias,
                     int rows)
{
    static const value none[ROWS] = {0};
    (void)rows;
    add_listed(sum[0], in->x, in->list, w, bias, in->even);
    add_listed(sum[1], in->x + in->even, in->list + in->even, w, none, in->odd);
}

#endif
