/* The arithmetic of the stages in float32; real_q24.h is the one in integers.  Every stage text is
 * written in these words, and the ranges in its comments are what fixed point relies on.
 *
 *   real, wide    a number; one that holds sums beyond the range of a real
 *   REAL(c)       a constant, >= 0
 *   Q12(n)        the integer n counts 1 / 4096
 *   MUL SQUARE DIV SQRT  of reals; DIV is the ratio of any two like numbers
 *   DIV16         a / b to 16 fraction bits, where that is enough; 0 <= a < 1/2 <= b
 *   PER_SECOND    a * 1000 / ms, for 0 < ms <= 1300; a real of +-64 at most
 *   HYPOT NORM    length of a vector of two and of three
 *   ABS           absolute value
 *   POSITIVE_PART  a, or 0 if it is negative
 *   PRODUCT       of two reals, as a wide of finer fraction, for sums of up to 2^23
 *   EXACT         of two reals, as a wide with all its bits, for sums of up to 2^15
 *   FROM_EXACT, ROOT_OF_EXACT   such a sum as a real, and its square root, if it is >= 0
 *   NORMALISE     multiplies x [n] by the power of 2 with which the largest |x| is in [1/2, 1), and
 *                 returns the exponent; SHIFT multiplies a real.  A float needs neither
 *   SATURATE      a sum of PRODUCTs as a real, clamped to +-64
 *   IS_NEAR       is a squared distance below 64 m^2?  Beyond that a sum is WIDE_MAX, above all sums
 *   INLINE_PRODUCTS  a function that is inline where a product is an instruction
 *   BY_HELIUM BY_VFP  1 where texts in the words of a Cortex-M's Helium or FPU compute with reals, else 0
 *   EPSILON       what rounding may leave of a zero, absolutely; a float's rounding is relative
 *
 * Of ranges in fixed point, which docs/proof.md proves:
 *   ASSERT        the condition holds, as intervals show
 *   ASSUME        it holds for the reason beside it, as numbers are related in a way that intervals lose
 *   MUL_TO DIV_TO SHIFT_TO   MUL, DIV, SHIFT with a result that is, for the reason beside it, within +-limit
 *   ADD_TO                   the same of a sum that a part is added to
 *   TRUNCATE_TO              the same of a wide, as a real
 *   WITHIN ALL_WITHIN        is a number within +-limit, and each coordinate of a point?
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_REAL_F32_H
#define EDML_REAL_F32_H

#include <math.h>
#include <stdint.h>
#include <string.h>

/* A product and a sum round separately, on every processor: fused, reordered or divided by way of a reciprocal
 * they would give other bits.  clang names no such option to the sources, but obeys them. */
#if defined(__clang__)
#pragma clang diagnostic push
#pragma clang diagnostic ignored "-Wignored-pragmas" /* the next is known on some processors alone */
#pragma float_control(precise, on)
#pragma clang diagnostic pop
#pragma clang fp contract(off) reassociate(off)
#elif defined(__GNUC__)
#pragma GCC optimize("fp-contract=off")
#endif

/* GCC tells of these from version 12 on.  Without NaN and infinity it could even lift one to a pose. */
#if defined(__ASSOCIATIVE_MATH__) || defined(__RECIPROCAL_MATH__) || (__FINITE_MATH_ONLY__ + 0)
#error "edmlift computes as IEEE 754 says: compile it without -ffast-math, -funsafe-math-optimizations, -fassociative-math, -freciprocal-math and -ffinite-math-only (-fno-fast-math undoes them)"
#endif

#if defined(__FLT_EVAL_METHOD__) && __FLT_EVAL_METHOD__ != 0 && __FLT_EVAL_METHOD__ != 16
#error "edmlift computes in float, not in a wider format: on x86 compile it with -msse2 -mfpmath=sse, elsewhere with -std=gnu99"
#endif

typedef float real;
typedef float wide;

/* By its bits, as a comparison of floats takes longer, most of all without an FPU.  a: no NaN. */
static inline float edml__positive_part(float a)
{
    int32_t bits;
    memcpy(&bits, &a, sizeof bits);
    bits = bits < 0 ? 0 : bits;
    memcpy(&a, &bits, sizeof a);
    return a;
}

#define INLINE_PRODUCTS EDML_INLINE
#define REAL(constant) constant##F
#define Q12(a) ((float)(a) * 0x1p-12F)
#define EPSILON 0.0F
#define MUL(a, b) ((a) * (b))
#define SQUARE(a) MUL(a, a)
#define DIV(a, b) ((a) / (b))
#define DIV16(a, b) ((a) / (b))
#define SQRT(a) sqrtf(a)
#define PER_SECOND(a, ms) ((a) * (1000.0F / (float)(ms)))
#define HYPOT(a, b) sqrtf((a) * (a) + (b) * (b))
#define NORM(a, b, c) sqrtf((a) * (a) + (b) * (b) + (c) * (c))
#define ABS(a) fabsf(a)
#define POSITIVE_PART(a) edml__positive_part(a)
#define PRODUCT(a, b) ((a) * (b))
#define EXACT(a, b) ((a) * (b))
#define FROM_EXACT(sum) (sum)
#define ROOT_OF_EXACT(sum) sqrtf(sum)
#define NORMALISE(x, n) ((void)(x), (void)(n), 0)
#define SHIFT(a, exponent) ((void)(exponent), (a))
#define SATURATE(sum) (sum)
#define IS_NEAR(square) ((void)(square), 1)
#define WIDE_MAX HUGE_VALF
#define ADD_TO(limit, sum, part) ((sum) += (part))
#define MUL_TO(limit, a, b) MUL(a, b)
#define DIV_TO(limit, a, b) DIV(a, b)
#define SHIFT_TO(limit, a, exponent) SHIFT(a, exponent)
#define TRUNCATE_TO(limit, sum) (sum)
#define WITHIN(a, most) (-(most) <= (a) && (a) <= (most))
#define ALL_WITHIN(p, most) (WITHIN((p).x, most) && WITHIN((p).y, most) && WITHIN((p).z, most))
#define ASSERT(condition) ((void)0)
#define ASSUME(condition) ((void)0)

#if defined(__ARM_FEATURE_MVE) && (__ARM_FEATURE_MVE & 2) && defined(__GNUC__) && !defined(__ARM_BIG_ENDIAN)
#define BY_HELIUM 1
#define BY_VFP 0
#elif defined(__GNUC__) && defined(__ARM_FP) && defined(__thumb2__)
#define BY_HELIUM 0
#define BY_VFP 1
#else
#define BY_HELIUM 0
#define BY_VFP 0
#endif

#endif
