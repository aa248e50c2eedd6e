/* Division and square root in integers.
 *
 * SPDX-License-Identifier: MIT
 */
#include "fixed.h"

/* One digit of base 2^16 of a quotient (D. Knuth, "The Art of Computer Programming" 2, 4.3.1,
 * algorithm D): of left 2^16 + next by the divisor, whose top bit is set; left < divisor.  Keeps the
 * remainder. */
static uint32_t next_digit(uint32_t *left, uint32_t next, uint32_t divisor)
{
    const uint32_t high = divisor >> 16, low = divisor & 0xFFFF;
    uint32_t digit = *left / high; /* too large by two at most */
    const uint32_t taken = digit * low;
    uint32_t rest = (*left - digit * high) << 16 | next;
    for (int n = 0; n < 2 && rest < taken; n++) {
        digit--;
        rest += divisor;
        if (rest < divisor) break; /* beyond 2^32, above `taken` */
    }
    *left = rest - taken;
    return digit;
}

int32_t edml__divide_q24(int32_t a, int32_t b)
{
    uint32_t divisor = b < 0 ? 0 - (uint32_t)b : (uint32_t)b;
    int shift = 0; /* makes the divisor's top bit set */
    for (int step = 16; step > 0; step /= 2) {
        if (divisor >> (32 - step) != 0) continue;
        divisor <<= step;
        shift += step;
    }
    /* |a| < 128 |b|: below 2^39 once shifted, and 2^63 in Q24; its upper word is below the divisor. */
    const uint64_t n = (uint64_t)(a < 0 ? 0 - (uint32_t)a : (uint32_t)a) << (24 + shift);
    uint32_t left = (uint32_t)(n >> 32);
    const uint32_t high = next_digit(&left, (uint32_t)n >> 16, divisor);
    const uint32_t low = next_digit(&left, (uint32_t)n & 0xFFFF, divisor);
    const uint32_t quotient = (high << 16 | low) + (left >= divisor - left); /* 2 left >= divisor */
    return (a < 0) == (b < 0) ? (int32_t)quotient : -(int32_t)quotient;
}

/* Digit by digit, base 2: the root of n >= 2^30, between 2^15 and 2^16; leaves n - root^2 <= 2 root. */
static uint32_t root_of_word(uint32_t *n)
{
    uint32_t root = 0, left = *n;
    for (uint32_t bit = UINT32_C(1) << 30; bit != 0; bit >>= 2) {
        const uint32_t tried = root + bit;
        root >>= 1;
        if (left < tried) continue;
        left -= tried;
        root += bit;
    }
    *n = left;
    return root;
}

/* One digit of base 2^16 by the root of the upper half, one by division (P. Zimmermann, "Karatsuba
 * square root", 1999): never too small, and too large by one at most. */
uint32_t edml__root(uint64_t n)
{
    if (n == 0) return 0;
    int halved = 0; /* the root is shifted right by this, n left by twice as much */
    for (int step = 16; step > 0; step /= 2) {
        if (n >> (64 - 2 * step) != 0) continue;
        n <<= 2 * step;
        halved += step;
    }
    uint32_t left = (uint32_t)(n >> 32); /* >= 2^30 */
    const uint32_t high = root_of_word(&left);
    /* (left 2^16 + the next 16 bits) / (2 high), both halved to stay below 2^32 */
    const uint32_t low = (left << 15 | (uint32_t)n >> 17) / high;
    uint32_t root = high << 16 | (low < 0xFFFF ? low : 0xFFFF);
    if ((uint64_t)root * root > n) root--;
    return root >> halved;
}
