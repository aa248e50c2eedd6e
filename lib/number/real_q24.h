/* The arithmetic of the stages in integers: a real is an int32_t with 24 fraction bits, from -128 to
 * 128 in steps of 6e-8.  real_f32.h says what the words mean.
 *
 * Nothing saturates and nothing is checked here.  Each stage says why its numbers stay in range;
 * tests/overflow compiles the stages with numbers that stop at the first one that does not.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_REAL_Q24_H
#define EDML_REAL_Q24_H

#include <float.h>

#include "fixed.h"

typedef int32_t real;
typedef int64_t wide;

#define INLINE_PRODUCTS EDML_INLINE_PRODUCTS
#define BY_HELIUM 0
#define BY_VFP 0
/* Folded by the compiler; a long constant stays what it is under -fsingle-precision-constant. */
#define REAL(constant) ((real)(constant##L * 16777216.0L + 0.5L))
#define Q12(a) ((real)(a) * 4096)
#define EPSILON 8
#define MUL(a, b) edml__multiply_q24(a, b) /* to the nearest; |a b| < 128 */
#define SQUARE(a) MUL(a, a)
#define DIV(a, b) edml__divide_q24(a, b)   /* error <= 1/2 unit in the last place */
#define DIV16(a, b) divide_q16(a, b)       /* error <= 2^-17 (1 + a / b^2) */
#define SQRT(a) sqrt_q24(a)                /* error < 1 unit, not too large */
#define PER_SECOND(a, ms) per_second_q24(a, ms)
#define HYPOT(a, b) hypot_q24(a, b)     /* error < 1 unit, not too large; result < 128 */
#define NORM(a, b, c) norm_q24(a, b, c) /* the same */
#define ABS(a) ((a) < 0 ? -(a) : (a))
#define POSITIVE_PART(a) ((a) > 0 ? (a) : 0)
#define PRODUCT(a, b) product_q40(a, b)
#define EXACT(a, b) edml__product(a, b)
#define FROM_EXACT(sum) ((real)(((sum) + (INT32_C(1) << 23)) >> 24))
#define ROOT_OF_EXACT(sum) ((real)edml__root((uint64_t)(sum)))
#define NORMALISE(x, n) normalise_q24(x, n)
#define SHIFT(a, exponent) shift_q24(a, exponent)
#define SATURATE(sum) saturate_q40(sum)
#define IS_NEAR(square) ((square) < INT32_C(64) << 24) /* m^2 */
#define WIDE_MAX INT64_MAX
#define ADD_TO(limit, sum, part) ((sum) += (part))
#define MUL_TO(limit, a, b) MUL(a, b)
#define DIV_TO(limit, a, b) DIV(a, b)
#define SHIFT_TO(limit, a, exponent) SHIFT(a, exponent)
#define TRUNCATE_TO(limit, sum) ((real)(sum))
#define WITHIN(a, most) (-(most) <= (a) && (a) <= (most))
#define ALL_WITHIN(p, most) (WITHIN((p).x, most) && WITHIN((p).y, most) && WITHIN((p).z, most))
#define ASSERT(condition) ((void)0)
#define ASSUME(condition) ((void)0)

/* The compiler rounds constants to Q24: everywhere alike. */
typedef char doubles_hold_24_fraction_bits[DBL_MANT_DIG >= 53 ? 1 : -1];

/* A negative number that is shifted to the right must round down, as it does everywhere; C leaves it
 * open. */
typedef char shifts_are_arithmetic[(-3 >> 1) == -2 ? 1 : -1];

/* By one division of 32 bits: a in Q32 over b in Q16 is a Q16. */
static inline real divide_q16(real a, real b)
{
    const uint32_t divisor = ((uint32_t)b + 128) >> 8;
    return (real)(((uint32_t)a * 256 + divisor / 2) / divisor * 256);
}

static inline wide product_q40(real a, real b) /* rounded down */ { return edml__product(a, b) >> 8; }

static inline real saturate_q40(wide sum)
{
    const wide limit = (wide)64 << 40;
    return (real)(((sum > limit ? limit : sum < -limit ? -limit : sum) + (INT32_C(1) << 15)) >> 16);
}

static inline real per_second_q24(real a, uint32_t ms)
{
    const uint32_t factor = (UINT32_C(1000) << 20) / ms; /* < 2^30 */
    const int64_t rate = edml__product(a, (int32_t)factor) >> 20, most = (INT64_C(1) << 30) - 1;
    return (real)(rate > most ? most : rate < -most ? -most : rate);
}

static inline real shift_q24(real a, int exponent) /* rounded down */
{
    return exponent < 0 ? a >> (exponent < -31 ? 31 : -exponent) : a * (INT32_C(1) << exponent);
}

/* Inline, because most callers have one number or two. */
static EDML_INLINE int normalise_q24(real *x, int n)
{
    uint32_t bits = 0; /* whose highest is that of the largest */
    for (int i = 0; i < n; i++) bits |= (uint32_t)ABS(x[i]);
    const int exponent = bits == 0 ? 0 : edml__leading_zeros(bits) - 8;
    for (int i = 0; i < n; i++) x[i] = exponent < 0 ? x[i] >> -exponent : x[i] * (INT32_C(1) << exponent);
    return exponent;
}

static inline real sqrt_q24(real a) { return a > 0 ? (real)edml__root((uint64_t)a << 24) : 0; }

static inline uint64_t square_q24(real a) { return (uint64_t)edml__product(a, a); } /* <= 2^62 */

static inline real hypot_q24(real a, real b) { return (real)edml__root(square_q24(a) + square_q24(b)); }

static inline real norm_q24(real a, real b, real c)
{
    return (real)edml__root(square_q24(a) + square_q24(b) + square_q24(c));
}

#endif
