/* number/fixed.c: division and square root in integers, against exact arithmetic.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdlib.h>

#include "number/real_q24.h"
#include "helpers.h"

/* The same text as where the processor has no instruction for a division. */
#undef EDML_DIVIDES
#define edml__root root_by_table
#define edml__divide_q24 divide_by_table
int32_t divide_by_table(int32_t a, int32_t b);
uint32_t root_by_table(uint64_t n);
#include "number/fixed.c"
#undef edml__root
#undef edml__divide_q24

static uint64_t bits64(rng *r) { return (uint64_t)rng_bits(r) << 32 | rng_bits(r); }

/* ---- Root ---------------------------------------------------------------------------------------- */

static void check_root(uint64_t n)
{
    const uint64_t root = edml__root(n);
    TEST_ASSERT_EQUAL_UINT32(root, root_by_table(n));
    const uint64_t next = root + 1; /* its square is 2^64 for the largest root */
    TEST_ASSERT_TRUE(root * root <= n);
    TEST_ASSERT_TRUE(next > UINT32_MAX || next * next > n);
}

static void roots_of_all_small_numbers(void)
{
    for (uint64_t n = 0; n < 1 << 20; n++) check_root(n);
}

/* Where the root changes: below, at and above squares of every size. */
static void roots_around_squares(void)
{
    rng r = rng_seed(71);
    for (int bits = 1; bits <= 32; bits++) {
        for (int n = 0; n < 20000; n++) {
            const uint64_t root = (rng_bits(&r) | UINT32_C(1) << 31) >> (32 - bits);
            check_root(root * root - 1);
            check_root(root * root);
            check_root(root * root + 2 * root); /* the last one before the next square */
        }
    }
}

/* All that the first digit of a root depends on. */
static void roots_of_all_upper_halves_of_a_word(void)
{
    for (uint64_t high = 1 << 14; high < 1 << 16; high++) {
        check_root(high << 48);
        check_root(((high + 1) << 48) - 1);
    }
}

static void roots_at_the_ends_and_around_powers_of_two(void)
{
    check_root(UINT64_MAX);
    check_root(UINT64_MAX - 1);
    check_root((uint64_t)UINT32_MAX * UINT32_MAX);
    check_root((uint64_t)UINT32_MAX * UINT32_MAX - 1);
    for (int bit = 0; bit < 64; bit++)
        for (int offset = -2; offset <= 2; offset++) check_root((UINT64_C(1) << bit) + (uint64_t)offset);
}

static void roots_of_random_numbers_of_every_size(void)
{
    rng r = rng_seed(72);
    for (int bits = 1; bits <= 64; bits++)
        for (int n = 0; n < 20000; n++) check_root(bits64(&r) >> (64 - bits));
}

/* ---- Ratio --------------------------------------------------------------------------------------- */

/* -|b| / 2 < |q b| - |a 2^24| <= |b| / 2: to the nearest, halves away from zero. */
static void check_ratio(int64_t a, int64_t b)
{
    const int64_t q = edml__divide_q24((int32_t)a, (int32_t)b);
    TEST_ASSERT_EQUAL_INT32(q, divide_by_table((int32_t)a, (int32_t)b));
    const int64_t wanted = (a < 0 ? -a : a) << 24;
    const int64_t error = (q < 0 ? -q : q) * (b < 0 ? -b : b) - wanted;
    TEST_ASSERT_TRUE(2 * error <= (b < 0 ? -b : b) && -2 * error < (b < 0 ? -b : b));
    TEST_ASSERT_TRUE(q == 0 || (q < 0) == ((a < 0) != (b < 0)));
}

static void ratios_of_small_numbers(void)
{
    for (int a = -400; a <= 400; a++)
        for (int b = -400; b <= 400; b++)
            if (b != 0 && abs(a) < 128 * abs(b)) check_ratio(a, b);
}

/* Numerators and divisors of every size whose ratio fits. */
static void ratios_of_random_numbers_of_every_size(void)
{
    rng r = rng_seed(73);
    for (int bits = 1; bits <= 31; bits++) {
        for (int smaller = 1; smaller <= 31; smaller++) {
            for (int n = 0; n < 1000; n++) {
                const int64_t a = rng_bits(&r) >> (32 - bits);
                const int64_t b = rng_bits(&r) >> (32 - smaller);
                if (a >= 128 * b) continue;
                check_ratio(a, b);
                check_ratio(-a, b);
                check_ratio(a, -b);
                check_ratio(-a, -b);
            }
        }
    }
}

static void ratios_at_the_ends(void)
{
    static const int64_t ends[] = {INT32_MIN,     INT32_MIN + 1, INT32_MAX - 1, INT32_MAX, 1 << 30,
                                   (1 << 30) - 1, (1 << 24) + 1, (1 << 24) - 1, 0xFFFF,    0x10000,
                                   0x10001,       0x7FFF0000,    0x7FFFFFFE,    1,         -1};
    for (int i = 0; i < 15; i++) {
        check_ratio(0, ends[i]);
        for (int j = 0; j < 15; j++)
            if (llabs(ends[i]) < 128 * llabs(ends[j])) check_ratio(ends[i], ends[j]);
    }
    for (int64_t b = 1; b < 1 << 24; b += 1 + b / 50) /* the largest quotients there are */
        check_ratio(128 * b - 1, b);
}

static void halves_go_away_from_zero(void)
{
    TEST_ASSERT_EQUAL_INT(1, edml__divide_q24(1, 1 << 25));
    TEST_ASSERT_EQUAL_INT(-1, edml__divide_q24(-1, 1 << 25));
    TEST_ASSERT_EQUAL_INT(-1, edml__divide_q24(1, -(1 << 25)));
    TEST_ASSERT_EQUAL_INT(0, edml__divide_q24(1, (1 << 25) + 1));
}

/* ---- real_q24.h ------------------------------------------------------------------------------------- */

static void quotients_of_16_bits_are_off_by_what_the_header_says(void)
{
    rng r = rng_seed(67);
    for (int n = 0; n < 200000; n++) {
        const int32_t a = (int32_t)(rng_bits(&r) >> 9); /* < 1/2 */
        const int32_t b = (1 << 23) + (int32_t)(rng_bits(&r) >> (6 + n % 18)); /* to 4.5 */
        const double x = ldexp(a, -24), y = ldexp(b, -24);
        TEST_ASSERT_TRUE(fabs(ldexp(divide_q16(a, b), -24) - x / y) <= ldexp(1 + x / (y * y), -17));
    }
}

static void rates_end_at_64_a_second(void)
{
    static const int32_t end = (1 << 30) - 1;
    TEST_ASSERT_EQUAL_INT32(end, per_second_q24(INT32_MAX, 1));
    TEST_ASSERT_EQUAL_INT32(-end, per_second_q24(-INT32_MAX, 1));
    TEST_ASSERT_EQUAL_INT32(end, per_second_q24(1 << 30, 999));
    TEST_ASSERT_INT32_WITHIN(64, (1 << 24) * 10, per_second_q24(1 << 24, 100));
    TEST_ASSERT_INT32_WITHIN(64, -(1 << 24), per_second_q24(-(1 << 24), 1000));
}

static void shifts_are_products_by_powers_of_two(void)
{
    for (int n = 0; n <= 7; n++) {
        TEST_ASSERT_EQUAL_INT32(-(5 << (20 + n)), shift_q24(-(5 << 20), n));
        TEST_ASSERT_EQUAL_INT32(-(5 << (20 - n)), shift_q24(-(5 << 20), -n));
    }
    TEST_ASSERT_EQUAL_INT32(0, shift_q24(INT32_MAX, -40));
    TEST_ASSERT_EQUAL_INT32(-1, shift_q24(INT32_MIN, -40)); /* rounded down */
}

static void the_largest_number_is_normalised_to_a_half_up_to_one(void)
{
    rng r = rng_seed(66);
    for (int n = 0; n < 500; n++) {
        int32_t x[5], was[5], largest = 0;
        for (int i = 0; i < 5; i++) was[i] = x[i] = (int32_t)rng_bits(&r) >> (2 + n % 28);
        const int exponent = normalise_q24(x, 5);
        for (int i = 0; i < 5; i++) {
            if (abs(x[i]) > largest) largest = abs(x[i]);
            TEST_ASSERT_EQUAL_INT32(shift_q24(was[i], exponent), x[i]);
        }
        TEST_ASSERT_TRUE(largest >= 1 << 23 && largest <= 1 << 24);
    }
    int32_t none[2] = {0, 0};
    TEST_ASSERT_EQUAL_INT(0, normalise_q24(none, 2));
}

static void numbers_of_16_bits_are_the_nearest_halves_up_and_limited(void)
{
    static const int32_t ends[] = {INT32_MIN, INT32_MIN + 1, -(1 << 27) - 2049, -(1 << 27), (1 << 27) - 2049,
                                   (1 << 27) - 2048, INT32_MAX - 1, INT32_MAX};
    rng r = rng_seed(67);
    for (int n = 0; n < 20000; n++) {
        const int32_t x = n < 8 ? ends[n] : (int32_t)rng_bits(&r) >> n % 31;
        const int64_t exact = ((int64_t)x + 2048) >> 12;
        const int64_t limited = exact > 32767 ? 32767 : exact < -32768 ? -32768 : exact;
        TEST_ASSERT_EQUAL_INT32(limited, edml__round_to_16_bits(x, 12));
    }
    TEST_ASSERT_EQUAL_INT32(0, edml__round_to_16_bits(-2048, 12));
    TEST_ASSERT_EQUAL_INT32(1, edml__round_to_16_bits(2048, 12));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(roots_of_all_small_numbers);
    RUN_TEST(roots_around_squares);
    RUN_TEST(roots_of_all_upper_halves_of_a_word);
    RUN_TEST(roots_at_the_ends_and_around_powers_of_two);
    RUN_TEST(roots_of_random_numbers_of_every_size);
    RUN_TEST(ratios_of_small_numbers);
    RUN_TEST(ratios_of_random_numbers_of_every_size);
    RUN_TEST(ratios_at_the_ends);
    RUN_TEST(halves_go_away_from_zero);
    RUN_TEST(quotients_of_16_bits_are_off_by_what_the_header_says);
    RUN_TEST(rates_end_at_64_a_second);
    RUN_TEST(shifts_are_products_by_powers_of_two);
    RUN_TEST(the_largest_number_is_normalised_to_a_half_up_to_one);
    RUN_TEST(numbers_of_16_bits_are_the_nearest_halves_up_and_limited);
    return UNITY_END();
}
