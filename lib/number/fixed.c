/* Division and square root in integers.
 *
 * SPDX-License-Identifier: MIT
 */
#include "fixed.h"

#ifndef EDML_COUNT_ZEROS
int edml__leading_zeros(uint32_t n)
{
    static const uint8_t zeros_of_four_bits[16] = {4, 3, 2, 2, 1, 1, 1, 1}; /* then none */
    int zeros = 28;
    if (n >> 16 != 0) {
        n >>= 16;
        zeros -= 16;
    }
    if (n >> 8 != 0) {
        n >>= 8;
        zeros -= 8;
    }
    if (n >> 4 != 0) {
        n >>= 4;
        zeros -= 4;
    }
    return zeros + zeros_of_four_bits[n];
}
#endif

#ifdef EDML_DIVIDES
#define reciprocal(divisor) 0
#define quotient(n, divisor, inverse) ((void)(inverse), (n) / (divisor))
#else

/* 2^15 / (k + 1/2), k = 128 to 255; by tests/python/test_house.py. */
static const uint8_t reciprocals[128] = {
    255, 253, 251, 249, 247, 245, 244, 242, 240, 238, 237, 235, 233, 232, 230, 228, 227, 225, 224,
    222, 221, 219, 218, 216, 215, 213, 212, 211, 209, 208, 207, 205, 204, 203, 202, 200, 199, 198,
    197, 196, 194, 193, 192, 191, 190, 189, 188, 187, 186, 185, 184, 183, 182, 181, 180, 179, 178,
    177, 176, 175, 174, 173, 172, 171, 170, 169, 168, 168, 167, 166, 165, 164, 163, 163, 162, 161,
    160, 159, 159, 158, 157, 156, 156, 155, 154, 153, 153, 152, 151, 151, 150, 149, 149, 148, 147,
    147, 146, 145, 145, 144, 143, 143, 142, 142, 141, 140, 140, 139, 139, 138, 137, 137, 136, 136,
    135, 135, 134, 133, 133, 132, 132, 131, 131, 130, 130, 129, 129, 128};

/* 2^31 / divisor for 2^15 <= divisor < 2^16, too small by up to 3: the table is good to 8 bits, and one step of
 * Newton's method to 15. */
static uint32_t reciprocal(uint32_t divisor)
{
    const uint32_t start = reciprocals[(divisor >> 8) - 128]; /* 2^23 / divisor */
    const int32_t off = (INT32_C(1) << 23) - (int32_t)(divisor * start);
    return (start << 8) + (uint32_t)((int32_t)start * off >> 15);
}

/* n / divisor, rounded down, for n < (divisor + 1) 2^16. */
static uint32_t quotient(uint32_t n, uint32_t divisor, uint32_t inverse)
{
    uint32_t digit = (n >> 16) * inverse >> 15; /* too small by five at most */
    for (n -= digit * divisor; n >= divisor; n -= divisor) digit++;
    return digit;
}

#endif

/* One digit of base 2^16 of a quotient (D. Knuth, "The Art of Computer Programming" 2, 4.3.1,
 * algorithm D): of left 2^16 + next by the divisor, whose top bit is set; left < divisor.  Keeps the
 * remainder.  inverse: the reciprocal of the divisor's upper half. */
static uint32_t next_digit(uint32_t *left, uint32_t next, uint32_t divisor, uint32_t inverse)
{
    const uint32_t high = divisor >> 16, low = divisor & 0xFFFF;
    uint32_t digit = quotient(*left, high, inverse); /* too large by two at most */
    const uint32_t taken = digit * low;
    uint32_t rest = (*left - digit * high) << 16 | next;
    while (rest < taken) {
        digit--;
        rest += divisor;
        if (rest < divisor) break; /* beyond 2^32, above `taken` */
    }
    *left = rest - taken;
    return digit;
}

int32_t edml__divide_q24(int32_t a, int32_t b)
{
    const int32_t sign = a ^ b;
    uint32_t divisor = b < 0 ? 0 - (uint32_t)b : (uint32_t)b, left = a < 0 ? 0 - (uint32_t)a : (uint32_t)a;
    const int shift = edml__leading_zeros(divisor);
    divisor <<= shift;
    /* |a| < 128 |b|: below 2^39 once shifted, and 2^63 in Q24; its upper word is below the divisor. */
    const uint64_t n = (uint64_t)left << (24 + shift);
    left = (uint32_t)(n >> 32);
    const uint32_t inverse = reciprocal(divisor >> 16);
    uint32_t whole = next_digit(&left, (uint32_t)n >> 16, divisor, inverse) << 16;
    whole |= next_digit(&left, (uint32_t)n & 0xFFFF, divisor, inverse);
    whole += left >= divisor - left; /* 2 left >= divisor */
    return sign < 0 ? -(int32_t)whole : (int32_t)whole;
}

/* 2^11 / root of k + 1/2, k = 64 to 255; by tests/python/test_house.py. */
static const uint8_t inverse_roots[192] = {
    255, 253, 251, 249, 247, 246, 244, 242, 241, 239, 237, 236, 234, 233, 231, 230, 228, 227, 225, 224,
    223, 221, 220, 219, 218, 216, 215, 214, 213, 212, 211, 210, 208, 207, 206, 205, 204, 203, 202, 201,
    200, 199, 198, 198, 197, 196, 195, 194, 193, 192, 191, 191, 190, 189, 188, 187, 187, 186, 185, 184,
    184, 183, 182, 181, 181, 180, 179, 179, 178, 177, 177, 176, 175, 175, 174, 173, 173, 172, 172, 171,
    170, 170, 169, 169, 168, 167, 167, 166, 166, 165, 165, 164, 164, 163, 163, 162, 162, 161, 161, 160,
    160, 159, 159, 158, 158, 157, 157, 156, 156, 155, 155, 155, 154, 154, 153, 153, 152, 152, 152, 151,
    151, 150, 150, 150, 149, 149, 148, 148, 148, 147, 147, 146, 146, 146, 145, 145, 145, 144, 144, 144,
    143, 143, 143, 142, 142, 141, 141, 141, 140, 140, 140, 140, 139, 139, 139, 138, 138, 138, 137, 137,
    137, 136, 136, 136, 135, 135, 135, 135, 134, 134, 134, 133, 133, 133, 133, 132, 132, 132, 132, 131,
    131, 131, 130, 130, 130, 130, 129, 129, 129, 129, 128, 128};

/* The root of n >= 2^30, between 2^15 and 2^16; leaves n - root^2 <= 2 root.  By the table the inverse root is
 * good to 8 bits, and by Newton's method to 15: with it the root is too small by 5 at most, and never too large
 * (tests/unit/test_fixed.c tries all upper halves of n, which are all that it depends on). */
static uint32_t root_of_word(uint32_t *n)
{
    const uint32_t high = *n >> 16, start = inverse_roots[(*n >> 24) - 64]; /* 2^7 / root(n / 2^32) */
    const int32_t off = (INT32_C(1) << 30) - (int32_t)(high * start * start);
    const uint32_t inverse = (start << 8) + (uint32_t)((int32_t)start * (off >> 10) >> 13);
    uint32_t root = high * inverse >> 15;
    *n -= root * root;
    for (; *n > 2 * root; root++) *n -= 2 * root + 1;
    return root;
}

/* One digit of base 2^16 by the root of the upper half, one by division (P. Zimmermann, "Karatsuba
 * square root", 1999): never too small, and too large by one at most. */
uint32_t edml__root(uint64_t n)
{
    if (n == 0) return 0;
    const uint32_t top = (uint32_t)(n >> 32);
    /* The root is shifted right by this, n left by twice as much. */
    const int halved = (top != 0 ? edml__leading_zeros(top) : 32 + edml__leading_zeros((uint32_t)n)) / 2;
    n <<= 2 * halved;
    uint32_t left = (uint32_t)(n >> 32); /* >= 2^30 */
    const uint32_t high = root_of_word(&left), next = (uint32_t)n;
    /* (left 2^16 + the upper half of next) / (2 high), both halved to stay below 2^32 */
    left = left << 15 | next >> 17;
    uint32_t low = quotient(left, high, reciprocal(high));
    if (low > UINT16_MAX) low = UINT16_MAX;
    left -= low * high;
    const int too_large = left < 1 << 15 && (left << 17 | (next & 0x1FFFF)) < low * low;
    return ((high << 16 | low) - (uint32_t)too_large) >> halved;
}
