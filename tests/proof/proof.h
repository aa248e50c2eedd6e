/* Stands before the texts of lib/ where Frama-C's EVA reads them: the words of lib/number/real_q24.h for an
 * analysis by intervals.
 *
 *   ASSERT   is proved: EVA complains unless it sees that the condition is true
 *   ASSUME   is believed: a comment beside it says why it is true, and tests/overflow watches it
 *   ADD_TO, DIV_TO, MUL_TO, SHIFT_TO, TRUNCATE_TO   the same of a result, which is within the limit: so
 *            no divisor is 0, and a sum that is truncated fits 64 bits
 *
 * Products and sums are those of the library.  Quotients and roots are bounds of what lib/number/fixed.c returns,
 * because intervals say nothing of its digits; tests/unit/test_fixed.c compares them with the exact ones.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_PROOF_H
#define EDML_PROOF_H

#include <math.h>
#include <string.h>

#include "api/api_q.h"

/* ---- Frama-C's ---- */

/*@ requires ordered: low <= high;
    assigns \result \from low, high;
    ensures within: low <= \result <= high; */
int32_t Frama_C_interval(int32_t low, int32_t high);

/*@ requires holds: condition != 0;
    assigns \nothing; */
void proved(int condition);

/*@ assigns \nothing;
    ensures never: \false; */
void not_here(void);

/* ---- Words ---- */

#undef ASSERT
#undef ASSUME
#undef ADD_TO
#undef DIV_TO
#undef MUL_TO
#undef SHIFT_TO
#undef TRUNCATE_TO
#undef REAL
#undef SQUARE
#undef HYPOT
#undef NORM
#undef NORMALISE
#define ASSERT(condition) proved(condition)
#define ASSUME(condition) ((condition) ? (void)0 : not_here())
#define ADD_TO(limit, sum, part) ((sum) = within(limit, (int64_t)(sum) + (part)))
#define DIV_TO(limit, a, b) quotient_to(limit, a, b)
#define MUL_TO(limit, a, b) product_to(limit, a, b)
#define SHIFT_TO(limit, a, exponent) shift_to(limit, a, exponent)
#define TRUNCATE_TO(limit, sum) Frama_C_interval(-(limit), limit)
#define REAL(constant) ((real)(constant * 16777216.0 + 0.5)) /* EVA has no long double */
#define SQUARE(a) square_q24_of(a)
#define HYPOT(a, b) length_of(a, b, 0)
#define NORM(a, b, c) length_of(a, b, c)
#define NORMALISE(x, n) normalise_to_1(x, n)

/* Of the rounded quotient. */
int32_t edml__divide_q24(int32_t a, int32_t b)
{
    const int64_t toward_zero = (int64_t)a * 16777216 / b;
    return (int32_t)(toward_zero + Frama_C_interval(-1, 1));
}

/* The root of n < 2^64, in floating point, is off by less than 1. */
uint32_t edml__root(uint64_t n)
{
    const int64_t root = (int64_t)sqrt((double)n) + Frama_C_interval(-1, 1);
    ASSUME(0 <= root && root <= UINT32_MAX);
    return (uint32_t)root;
}

static uint64_t square_of(real a)
{
    const int64_t size = a < 0 ? -(int64_t)a : a;
    return (uint64_t)size * (uint64_t)size;
}

static real square_q24_of(real a) { return (real)((square_of(a) + (1 << 23)) >> 24); }

static real length_of(real a, real b, real c)
{
    return (real)edml__root(square_of(a) + square_of(b) + square_of(c));
}

/* Rounded up or down. */
static real within(real limit, int64_t result)
{
    const int64_t rounded = result + Frama_C_interval(-1, 1), most = (int64_t)limit + 1;
    ASSUME(WITHIN(rounded, most));
    return (real)rounded;
}

static real quotient_to(real limit, real a, real b)
{
    ASSUME(b != 0);
    const int64_t up = b > 0 ? (int64_t)a * 16777216 / b : 0, down = b < 0 ? (int64_t)a * 16777216 / b : 0;
    return within(limit, up + down);
}

static real product_to(real limit, real a, real b)
{
    return within(limit, edml__product(a, b) / 16777216);
}

static real shift_to(real limit, real a, int exponent)
{
    (void)a, (void)exponent;
    return Frama_C_interval(-limit, limit);
}

static int normalise_to_1(real *x, int n)
{
    for (int i = 0; i < n; i++) x[i] = Frama_C_interval(1 - (1 << 24), (1 << 24) - 1);
    return Frama_C_interval(-7, 23);
}

#endif
