/* Products, division and square root for real_q24.h.  Not part of the public interface.
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

/* a b, exactly; and (a b + 2^23) >> 24, to the nearest, for |a b| < 2^55. */
#if defined(__GNUC__) && !defined(__clang__) && (defined(__ARM_ARCH_6M__) || defined(__ARM_ARCH_8M_BASE__))
#define EDML_MULTIPLY_V6M
#define EDML_INLINE_PRODUCTS EDML_NOINLINE /* each is a call: not inline what has many */
EDML_INTERNAL int64_t edml__product(int32_t a, int32_t b);
EDML_INTERNAL int32_t edml__multiply_q24(int32_t a, int32_t b);
#else
#define EDML_INLINE_PRODUCTS EDML_INLINE
static inline int64_t edml__product(int32_t a, int32_t b) { return (int64_t)a * b; }

static inline int32_t edml__multiply_q24(int32_t a, int32_t b)
{
    return (int32_t)((edml__product(a, b) + (INT32_C(1) << 23)) >> 24);
}
#endif

/* (a b + 2^31) >> 32 */
static inline int32_t edml__high_product(int32_t a, int32_t b)
{
#ifdef EDML_HIGH_PRODUCT
    int32_t high;
    EDML_HIGH_PRODUCT(high, a, b);
    return high;
#else
    return (int32_t)((edml__product(a, b) + (INT64_C(1) << 31)) >> 32);
#endif
}

/* x limited to 0 to 2^bits - 1; bits is a constant. */
static EDML_INLINE int32_t edml__saturate(int32_t x, int bits)
{
#ifdef EDML_SATURATE
    int32_t y;
    EDML_SATURATE(y, bits, x);
    return y;
#else
    const int32_t most = (INT32_C(1) << bits) - 1;
    return x < 0 ? 0 : x < most ? x : most;
#endif
}

/* x / 2^shift to the nearest, halves up, limited to 16 bits. */
static EDML_INLINE int32_t edml__round_to_16_bits(int32_t x, int shift)
{
    const int32_t twice = (x >> (shift - 1)) + 1;
#ifdef EDML_HALVE_TO_16_BITS
    int32_t y;
    EDML_HALVE_TO_16_BITS(y, twice);
    return y;
#else
    const int32_t rounded = twice >> 1;
    return rounded < INT16_MIN ? INT16_MIN : rounded < INT16_MAX ? rounded : INT16_MAX;
#endif
}

/* Zeros before the highest bit of n > 0. */
#ifdef EDML_COUNT_ZEROS
static inline int edml__leading_zeros(uint32_t n) { return EDML_COUNT_ZEROS(n); }
#else
EDML_INTERNAL int edml__leading_zeros(uint32_t n);
#endif

#endif
