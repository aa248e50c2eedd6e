/* Division and square root for real_q24.h.  Not part of the public interface.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_FIXED_H
#define EDML_FIXED_H

#include <stdint.h>

#include "compiler.h"

/* a / b in Q24, to the nearest (halves away from zero).  Both have the same number of fraction bits,
 * whichever it is.  b != 0, and the result must fit: |a / b| < 128. */
EDML_INTERNAL int32_t edml__divide_q24(int32_t a, int32_t b);

/* The largest r with r r <= n: exact. */
EDML_INTERNAL uint32_t edml__root(uint64_t n);

#endif
