/* dot8(): eight rows of a layer.  Portable C, which the processor's own must equal bit for bit.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_DOT8_H
#define EDML_DOT8_H

#include "weights.h"

#ifdef DOT8 /* the processor's own */
#include DOT8
#else

#include "eight_sums.h"

/* y = b + W x of eight rows; y may be b.  Leaving a zero out changes no bit, as no sum is ever -0: no bias is. */
static EDML_NOINLINE void dot8(value y[EDML_ROWS], const activation *x, const weight *w, const value *b,
                               int inputs)
{
    EIGHT_SUMS(b);
    for (const activation *const end = x + inputs; x < end; x++, w += EDML_ROWS) {
        const activation xi = *x;
        if (SKIPS_ZEROS && xi == 0) continue;
        ADD_TO_EIGHT(w, xi);
    }
    STORE_EIGHT(y);
}

#endif
#endif
