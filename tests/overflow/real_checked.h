/* The words of lib/number/real_q24.h in integers that watch themselves.  Results are those of real_q24.h,
 * bit for bit.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_REAL_CHECKED_H
#define EDML_REAL_CHECKED_H

#include "checked.h"

extern "C" {
#include "number/fixed.h"
}

typedef checked<int32_t> real;
typedef checked<int64_t> wide;

#define REAL(constant) real::from((__int128)(constant##L * 16777216.0L + 0.5L))
#define Q12(a) (real(a) * 4096)
#define INLINE_PRODUCTS EDML_INLINE
#define BY_HELIUM 0
#define BY_VFP 0
#define EPSILON 8
#define MUL(a, b) checked_mul(a, b)
#define SQUARE(a) MUL(a, a)
#define DIV(a, b) checked_div(a, b)
#define DIV16(a, b) checked_div16(a, b)
#define SQRT(a) checked_sqrt(a)
#define PER_SECOND(a, ms) checked_per_second(a, ms)
#define HYPOT(a, b) checked_norm(a, b, 0)
#define NORM(a, b, c) checked_norm(a, b, c)
#define ABS(a) ((a) < 0 ? -(a) : (a))
#define POSITIVE_PART(a) ((a) > 0 ? (a) : 0)
#define PRODUCT(a, b) checked_product(a, b)
#define EXACT(a, b) checked_exact(a, b)
#define FROM_EXACT(sum) checked_from_exact(sum)
#define ROOT_OF_EXACT(sum) checked_root(sum)
#define NORMALISE(x, n) checked_normalise(x, n)
#define SHIFT(a, exponent) checked_shift(a, exponent)
#define SATURATE(sum) checked_saturate(sum)
#define IS_NEAR(square) ((square) < real(64 << 24))
#define WIDE_MAX wide::from(INT64_MAX)
#define ADD_TO(limit, sum, part) ((sum) = checked_to(limit, (sum) + (part)))
#define MUL_TO(limit, a, b) checked_to(limit, MUL(a, b))
#define DIV_TO(limit, a, b) checked_to(limit, DIV(a, b))
#define SHIFT_TO(limit, a, exponent) checked_to(limit, SHIFT(a, exponent))
#define TRUNCATE_TO(limit, sum) checked_to(limit, real::from((sum).value()))
#define ASSERT(condition) checked_condition([&]() -> bool { return condition; })
#define ASSUME(condition) ASSERT(condition)
#define WITHIN(a, most) (-(most) <= (a) && (a) <= (most))
#define ALL_WITHIN(p, most) (WITHIN((p).x, most) && WITHIN((p).y, most) && WITHIN((p).z, most))

/* Its own operations do not count. */
template <typename Condition> static inline void checked_condition(Condition holds)
{
    const checked_tally before = tally;
    const bool is_true = holds();
    tally = before;
    if (!is_true) tally.overflows++;
}

static inline real checked_mul(real a, real b)
{
    tally.products++;
    return real::from(((__int128)a.value() * b.value() + (1 << 23)) >> 24);
}

/* One unit more is rounding. */
static inline real checked_to(real limit, real result)
{
    if (result.value() > limit.value() + 1 || result.value() < -limit.value() - 1) tally.overflows++;
    return result;
}

static inline wide checked_product(real a, real b)
{
    tally.products++;
    return wide::from(((__int128)a.value() * b.value()) >> 8);
}

static inline wide checked_exact(real a, real b)
{
    tally.products++;
    return wide::from((__int128)a.value() * b.value());
}

static inline real checked_from_exact(wide sum)
{
    return real::from(((__int128)sum.value() + (1 << 23)) >> 24);
}

static inline real checked_root(wide sum)
{
    tally.roots++;
    if (sum < 0) return tally.overflows++, real(0);
    return real::from(edml__root((uint64_t)sum.value()));
}

static inline real checked_shift(real a, int exponent)
{
    return real::from(exponent < 0 ? a.value() >> (exponent < -31 ? 31 : -exponent)
                                   : (__int128)a.value() * (1 << exponent));
}

static inline int checked_normalise(real *x, int n)
{
    uint32_t bits = 0;
    for (int i = 0; i < n; i++) bits |= (uint32_t)ABS(x[i]).value();
    const int exponent = bits == 0 ? 0 : edml__leading_zeros(bits) - 8;
    for (int i = 0; i < n; i++) x[i] = checked_shift(x[i], exponent);
    return exponent;
}

static inline real checked_saturate(wide sum)
{
    const __int128 limit = (__int128)64 << 40, exact = sum.value();
    return real::from(((exact > limit ? limit : exact < -limit ? -limit : exact) + (1 << 15)) >> 16);
}

static inline real checked_div(real a, real b)
{
    tally.ratios++;
    const int64_t n = (int64_t)a.value() * (1 << 24), d = b.value();
    if (d == 0 || n / d >= INT32_MAX || n / d <= -INT32_MAX) return tally.overflows++, real(0);
    return real::from(edml__divide_q24(a.value(), b.value()));
}

static inline real checked_div16(real a, real b)
{
    tally.ratios++;
    if (b.value() < 1 << 23 || a < 0 || a.value() >= 1 << 23) return tally.overflows++, real(0);
    const int64_t divisor = ((int64_t)b.value() + 128) >> 8;
    return real::from(((int64_t)a.value() * 256 + divisor / 2) / divisor * 256);
}

static inline real checked_per_second(real a, uint32_t ms)
{
    tally.ratios++;
    if (ms == 0 || ms > 1300) return tally.overflows++, real(0);
    const int64_t factor = (INT64_C(1000) << 20) / ms, most = (INT64_C(1) << 30) - 1;
    const int64_t rate = a.value() * factor >> 20;
    return real::from(rate > most ? most : rate < -most ? -most : rate);
}

static inline real checked_sqrt(real a)
{
    tally.roots++;
    return a > 0 ? real::from(edml__root((uint64_t)a.value() << 24)) : real(0);
}

static inline real checked_norm(real a, real b, real c)
{
    tally.roots++;
    const __int128 squares = (__int128)a.value() * a.value() + (__int128)b.value() * b.value() +
                             (__int128)c.value() * c.value(); /* < 2^64 */
    return real::from(edml__root((uint64_t)squares));
}

#endif
