/* rows.h in integers for processors that make one product at a time: eight rows, of the inputs that are not
 * zero, which are listed once a layer.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_ROWS_LISTED_H
#define EDML_ROWS_LISTED_H

#include "eight_sums.h"
#include "rows_some_inputs.h"

enum { ROWS = EDML_ROWS };

#ifdef ADD_LISTED /* the processor's own */
#include ADD_LISTED
#else

/* y = b + W x of eight rows; list: where in the weights each x is. */
static EDML_NOINLINE void add_listed(value y[EDML_ROWS], const activation *x, const uint8_t *list,
                                     const weight *weights, const value *b)
{
    EIGHT_SUMS(b);
    int i = *list;
    if (i != LAST_OF_LIST) { /* asked behind each input after that, which takes a branch less */
        do {
            const weight *const w = weights + EDML_ROWS * i;
            const activation xi = *x++;
            ADD_TO_EIGHT(w, xi);
            i = *++list;
        } while (i != LAST_OF_LIST);
    }
    STORE_EIGHT(y);
}
#endif

static void sum_rows(value sum[2][ROWS], const layer_inputs *in, const weight *w, const value *bias,
                     int rows)
{
    static const value none[ROWS] = {0};
    (void)rows;
    add_listed(sum[0], in->x, in->list, w, bias);
    add_listed(sum[1], in->x + in->even, in->list + in->even + 1, w, none);
}

#endif
