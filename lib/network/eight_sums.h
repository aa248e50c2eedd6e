/* Eight sums at a time, in eight registers, each in the order of the inputs: the compiler may use vector
 * instructions, and the bits are the same without them.  What uses them is out of line, because its loop needs all
 * of a Cortex-M's registers.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_EIGHT_SUMS_H
#define EDML_EIGHT_SUMS_H

#include "weights.h"

#define EIGHT_SUMS(b)                                                                                      \
    value s0 = (b)[0], s1 = (b)[1], s2 = (b)[2], s3 = (b)[3], s4 = (b)[4], s5 = (b)[5], s6 = (b)[6],       \
          s7 = (b)[7]

/* An input xi, times the eight weights w that read it. */
#define ADD_TO_EIGHT(w, xi)                                                                                \
    (s0 += (value)(w)[0] * (xi), s1 += (value)(w)[1] * (xi), s2 += (value)(w)[2] * (xi),                   \
     s3 += (value)(w)[3] * (xi), s4 += (value)(w)[4] * (xi), s5 += (value)(w)[5] * (xi),                   \
     s6 += (value)(w)[6] * (xi), s7 += (value)(w)[7] * (xi))

#define STORE_EIGHT(y)                                                                                     \
    ((y)[0] = s0, (y)[1] = s1, (y)[2] = s2, (y)[3] = s3, (y)[4] = s4, (y)[5] = s5, (y)[6] = s6, (y)[7] = s7)

#endif
