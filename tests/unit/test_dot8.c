/* network/dot8.h, the portable one, in float: the order and the rounding that dot8_vfp.h must equal.
 * tests/python/test_bits.py runs that one.
 *
 * SPDX-License-Identifier: MIT
 */
#include "helpers.h"
#include "network/weights_f32.h"

#include "network/dot8.h"

enum { MOST = 200 };

static float x[MOST], w[EDML_ROWS * MOST], b[EDML_ROWS], y[EDML_ROWS], plain[EDML_ROWS];

static void fill(rng *r)
{
    for (int n = 0; n < MOST; n++) x[n] = rng_bits(r) % 3 == 0 ? 0 : gauss(r);
    for (int n = 0; n < EDML_ROWS * MOST; n++) w[n] = gauss(r);
    for (int k = 0; k < EDML_ROWS; k++) b[k] = gauss(r);
}

/* Each row's sum in the order of the inputs; product and sum are rounded one after the other. */
static void expect(int inputs)
{
    for (int k = 0; k < EDML_ROWS; k++) {
        plain[k] = b[k];
        for (int n = 0; n < inputs; n++) {
            volatile float product = x[n] * w[EDML_ROWS * n + k];
            plain[k] += product;
        }
    }
}

static void sums_are_in_order_bit_for_bit(void)
{
    rng r = rng_seed(1);
    for (int inputs = 1; inputs <= MOST; inputs++) {
        fill(&r);
        expect(inputs);
        dot8(y, x, w, b, inputs);
        TEST_ASSERT_SAME_BYTES(plain, y);
        dot8(b, x, w, b, inputs); /* in place */
        TEST_ASSERT_SAME_BYTES(plain, b);
    }
}

/* So that it does not matter whether they are left out. */
static void zeros_of_either_sign_change_no_bit(void)
{
    rng r = rng_seed(2);
    fill(&r);
    b[0] = 0;
    for (int n = 0; n < MOST; n++) x[n] = n % 2 ? -0.0F : 0.0F;
    dot8(y, x, w, b, MOST);
    TEST_ASSERT_SAME_BYTES(b, y);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(sums_are_in_order_bit_for_bit);
    RUN_TEST(zeros_of_either_sign_change_no_bit);
    return UNITY_END();
}
