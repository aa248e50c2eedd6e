/* rows.h in float for processors with vectors of four numbers, or of eight where it is compiled for AVX: up to
 * 32 rows at a time, so that no sum waits for another.  Each is in the order of the inputs, as in dot8.h: the
 * same bits.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_ROWS_VECTOR_H
#define EDML_ROWS_VECTOR_H

#include "weights.h"

enum { ROWS = 4 * EDML_ROWS };
#define SLOT(k) (k)
#define WEIGHTS_OF(layer, row) ((layer)->weight + (row) * (layer)->inputs)

enum { LANES = __BIGGEST_ALIGNMENT__ < 32 ? 4 : 8 };
typedef float lanes __attribute__((vector_size(4 * LANES), aligned(4), may_alias));

/* Those of x [inputs] that are not zero.  No branch depends on them: none is mispredicted. */
static int list_inputs(uint8_t list[EDML_MAX_UNITS], const activation *x, int inputs)
{
    int count = 0;
    for (int i = 0; i < inputs; i++) {
        list[count] = (uint8_t)i;
        count += x[i] != 0;
    }
    return count;
}

/* sum: of `groups` times EDML_ROWS rows, a constant; w: those of the first group, the next ones at `stride`. */
static EDML_INLINE void add_listed(value *sum, const activation *x, const weight *w, const uint8_t *list,
                                   int count, int stride, int groups)
{
    lanes s[ROWS / LANES];
    const int vectors = groups * EDML_ROWS / LANES;
#pragma GCC unroll 8
    for (int v = 0; v < vectors; v++) s[v] = *(const lanes *)(sum + LANES * v);
    for (const uint8_t *const end = list + count; list < end; list++) {
        const value xi = x[*list];
        const weight *const wi = w + *list * EDML_ROWS;
#pragma GCC unroll 8
        for (int v = 0; v < vectors; v++)
            s[v] += *(const lanes *)(wi + LANES * v / EDML_ROWS * stride + LANES * v % EDML_ROWS) * xi;
    }
#pragma GCC unroll 8
    for (int v = 0; v < vectors; v++) *(lanes *)(sum + LANES * v) = s[v];
}

static void add_part(value sum[ROWS], const activation *x, const weight *w, int inputs, int stride,
                     int rows)
{
    uint8_t list[EDML_MAX_UNITS];
    const int count = list_inputs(list, x, inputs);
    if (rows == 4 * EDML_ROWS)
        add_listed(sum, x, w, list, count, stride, 4);
    else if (rows == 3 * EDML_ROWS)
        add_listed(sum, x, w, list, count, stride, 3);
    else if (rows == 2 * EDML_ROWS)
        add_listed(sum, x, w, list, count, stride, 2);
    else
        add_listed(sum, x, w, list, count, stride, 1);
}

static void sum_rows(value sum[2][ROWS], const activation *x, const weight *w, const value *bias, int even,
                     int odd, int rows)
{
    for (int k = 0; k < rows; k++) {
        sum[0][k] = bias[k];
        sum[1][k] = 0;
    }
    add_part(sum[0], x, w, even, EDML_ROWS * (even + odd), rows);
    add_part(sum[1], x + even, w + EDML_ROWS * even, odd, EDML_ROWS * (even + odd), rows);
}

#endif
