/* Division and square root of Q24, that real_q24.h speaks of.  Not part of the public interface.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_FIXED_H
#define EDML_FIXED_H

#include <stdint.h>

/* a / b in Q24, to the nearest (halves away from zero).  Both have the same number of fraction bits,
 * whatever it is.  b != 0, and the result must fit: |a / b| < 128. */
int32_t edml__divide_q24(int32_t a, int32_t b);

/* The largest r with r r <= n: exact. */
uint32_t edml__root(uint64_t n);

#endif
