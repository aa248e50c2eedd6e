/* rows.h in float for processors with vectors of four numbers, or of eight where it is compiled for AVX: up to
 * 32 rows at a time, so that no sum waits for another.  Each is in the order of the inputs, as in dot8.h: the
 * same bits.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_ROWS_VECTOR_H
#define EDML_ROWS_VECTOR_H

#include "rows_some_inputs.h"

enum { ROWS = 4 * EDML_ROWS };

enum { LANES = __BIGGEST_ALIGNMENT__ < 32 ? 4 : 8 };
typedef float lanes __attribute__((vector_size(4 * LANES), aligned(4), may_alias));

/* sum: of `groups` times EDML_ROWS rows, a constant; w: those of the first group, the next ones at `stride`. */
static EDML_INLINE void add_listed(value *sum, const activation *x, const weight *w, const uint8_t *list,
                                   int count, int stride, int groups)
{
    lanes s[(int)ROWS / LANES];
    const int vectors = groups * EDML_ROWS / LANES;
#pragma GCC unroll 8
    for (int v = 0; v < vectors; v++) s[v] = *(const lanes *)(sum + LANES * v);
    for (const uint8_t *const end = list + count; list < end; list++) {
        const value xi = *x++;
        const weight *const wi = w + *list * EDML_ROWS;
#pragma GCC unroll 8
        for (int v = 0; v < vectors; v++)
            s[v] += *(const lanes *)(wi + LANES * v / EDML_ROWS * stride + LANES * v % EDML_ROWS) * xi;
    }
#pragma GCC unroll 8
    for (int v = 0; v < vectors; v++) *(lanes *)(sum + LANES * v) = s[v];
}

static void add_part(value sum[ROWS], const activation *x, const weight *w, const uint8_t *list, int count,
                     int stride, int rows)
{
    if (rows == 4 * EDML_ROWS)
        add_listed(sum, x, w, list, count, stride, 4);
    else if (rows == 3 * EDML_ROWS)
        add_listed(sum, x, w, list, count, stride, 3);
    else if (rows == 2 * EDML_ROWS)
        add_listed(sum, x, w, list, count, stride, 2);
    else
        add_listed(sum, x, w, list, count, stride, 1);
}

static void sum_rows(value sum[2][ROWS], const layer_inputs *in, const weight *w, const value *bias,
                     int rows)
{
    for (int k = 0; k < rows; k++) {
        sum[0][k] = bias[k];
        sum[1][k] = 0;
    }
    add_part(sum[0], in->x, w, in->list, in->even, EDML_ROWS * in->inputs, rows);
    add_part(sum[1], in->x + in->even, w, in->list + in->even + 1, in->odd, EDML_ROWS * in->inputs, rows);
}

#endif
