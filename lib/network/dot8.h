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

#define SLOT(k) (k) /* where unit k is kept */

/* y = b + W x of eight rows; y may be b.  Eight registers hold the sums, each in the order of the inputs:
 * the compiler may use vector instructions, and the bits are the same without them.  Leaving a
 * zero out changes no bit, as no sum is ever -0: no bias is.  Out of line, because the loop needs all of a
 * Cortex-M's registers. */
static EDML_NOINLINE void dot8(value y[EDML_ROWS], const activation *x, const weight *w, const value *b,
                               int inputs)
{
    value s0 = b[0], s1 = b[1], s2 = b[2], s3 = b[3], s4 = b[4], s5 = b[5], s6 = b[6], s7 = b[7];
    for (const activation *const end = x + inputs; x < end; x++, w += EDML_ROWS) {
        const activation xi = *x;
        if (SKIPS_ZEROS && xi == 0) continue;
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

#endif
#endif
