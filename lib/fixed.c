/* Division and square root in whole numbers.
 *
 * SPDX-License-Identifier: MIT
 */
#include "fixed.h"

int32_t edml__divide_q24(int64_t a, int64_t b)
{
    const uint64_t n = (a < 0 ? 0 - (uint64_t)a : (uint64_t)a) << 24; /* < 2^63 */
    const uint64_t d = b < 0 ? 0 - (uint64_t)b : (uint64_t)b;
    const int32_t quotient = (int32_t)((n + d / 2) / d);
    return (a < 0) == (b < 0) ? quotient : -quotient;
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
