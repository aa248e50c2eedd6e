/* lift/tridiagonal.h from within: the largest eigenvalue of a symmetric band, in either arithmetic.  A wrong one
 * costs the MDS three times the time, and no more: so nothing but these tests would notice.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>

#include "native.h"

#include "lift/tridiagonal.h"

enum { MOST = EDML_JOINTS - 1 };
#ifndef EDML_TEST_Q24
#define NUMBER_TOLERANCE 2e-6
#else
#define NUMBER_TOLERANCE 4e-6 /* a few dozen roundings to 2^-24 */
#endif

enum { LENGTH = 2 * MOST * sizeof(real) };
static real memory[1 + 2 * MOST], *const band = memory + 1; /* behind what is beside an axis before */
static double diagonal[MOST], beside[MOST]; /* the same; beside[i] stands between i and i + 1 */
static int order;

static void read_band(void)
{
    for (int i = 0; i < order; i++) {
        diagonal[i] = (double)from_real(band[2 * i]);
        beside[i] = i + 1 < order ? (double)from_real(band[2 * i + 1]) : 0;
    }
}

/* Entries within 1.  The Gram matrix of a body has three large eigenvalues; others have any. */
static void random_band(rng *r, int n, float smallest)
{
    order = n;
    for (int i = 0; i < n; i++) {
        const float size = i < 3 ? 0.9F : smallest;
        band[2 * i] = to_real(uniform(r, -size, size));
        band[2 * i + 1] = i + 1 < n ? to_real(uniform(r, -size, size)) : 0;
    }
    read_band();
}

static double norm_of_band(void)
{
    double square = 0;
    for (int i = 0; i < order; i++) square += diagonal[i] * diagonal[i] + 2 * beside[i] * beside[i];
    return sqrt(square);
}

/* How many eigenvalues are below x, by Sturm's sequence. */
static int count_below(double x)
{
    int below = 0;
    double pivot = 1;
    for (int i = 0; i < order; i++) {
        pivot = diagonal[i] - x - (i > 0 ? beside[i - 1] * beside[i - 1] / pivot : 0);
        if (pivot == 0) pivot = 1e-300;
        below += pivot < 0;
    }
    return below;
}

/* The eigenvalue that k others are above. */
static double eigenvalue_below(int k)
{
    double low = -3, high = 3;
    for (int n = 0; n < 100; n++) {
        const double middle = (low + high) / 2;
        if (count_below(middle) >= order - k)
            high = middle;
        else
            low = middle;
    }
    return (low + high) / 2;
}

static void a_band_is_divided_by_its_norm(void)
{
    rng r = rng_seed(501);
    for (int n = 0; n < 200; n++) {
        real before[2 * MOST];
        random_band(&r, 2 + n % 12, n % 3 ? 0.5F : 0.01F);
        memcpy(before, band, LENGTH);
        const double expected = norm_of_band();
        const double norm = (double)from_real(divide_by_norm(band, order));
        TEST_ASSERT_FLOAT_WITHIN((float)(3 * NUMBER_TOLERANCE), (float)expected, (float)norm);
        for (int i = 0; i < 2 * order - 1; i++) {
            const double was = (double)from_real(before[i]), is = (double)from_real(band[i]);
            TEST_ASSERT_FLOAT_WITHIN((float)(NUMBER_TOLERANCE / expected), (float)(was / expected),
                                     (float)is);
        }
    }
    memset(band, 0, LENGTH);
    TEST_ASSERT_TRUE(divide_by_norm(band, 13) == 0);
}

/* Within a hundredth of the gap to the next one, or to rounding. */
static void the_largest_eigenvalue_is_found(void)
{
    rng r = rng_seed(502);
    double worst = 0;
    for (int n = 0; n < 1000; n++) {
        random_band(&r, 2 + n % 12, n % 3 == 0 ? 0.9F : n % 3 == 1 ? 0.1F : 0.001F);
        (void)divide_by_norm(band, order);
        read_band();
        const double largest = eigenvalue_below(0), gap = largest - eigenvalue_below(1);
        const double found = (double)from_real(largest_eigenvalue(band, order));
        if (gap < 0.01) continue; /* it may be wrong */
        worst = fmax(worst, fabs(found - largest));
        TEST_ASSERT_FLOAT_WITHIN((float)(NUMBER_TOLERANCE + 1e-7 / gap), (float)largest, (float)found);
    }
    printf("tridiagonal: eigenvalues off by %.1e at most\n", worst);
}

/* Laguerre's steps cube the error: two or three lead there, and hardly ever more than four. */
static void a_few_steps_are_enough(void)
{
    rng r = rng_seed(503);
    int late = 0;
    for (int n = 0; n < 500; n++) {
        random_band(&r, MOST, n % 2 ? 0.1F : 0.001F);
        (void)divide_by_norm(band, order);
        read_band();
        const double largest = eigenvalue_below(0);
        if (largest - eigenvalue_below(1) < 0.05) continue;
        real x = to_real(1);
        for (int step = 0; step < 4; step++) {
            minors f, slope, curve;
            characteristic(&f, &slope, &curve, band, order, x);
            x -= laguerre_step(&f, &slope, &curve, order, to_real(2.0F * MOST / (MOST - 1)));
        }
        late += fabs((double)from_real(x) - largest) > 1e-4;
    }
    printf("tridiagonal: %d of 500 need more than four steps\n", late);
    TEST_ASSERT_TRUE(late <= 5);
}

/* f, f' and f'' / 2 are those of the product of (x - eigenvalue). */
static void the_characteristic_polynomial_has_its_derivatives(void)
{
    rng r = rng_seed(504);
    for (int n = 0; n < 300; n++) {
        random_band(&r, 2 + n % 12, n % 2 ? 0.5F : 0.05F);
        (void)divide_by_norm(band, order);
        read_band();
        const double x = eigenvalue_below(0) + 0.1 + 0.5 * (double)uniform(&r, 0, 1);
        double value = 1, first = 0, second = 0; /* the last one: f'' / 2 */
        for (int k = 0; k < order; k++) {
            const double factor = x - eigenvalue_below(k);
            second = second * factor + first;
            first = first * factor + value;
            value *= factor;
        }
        minors f, slope, curve;
        characteristic(&f, &slope, &curve, band, order, to_real((float)x));
        const double unit = ldexp(1, slope.exponent), scale = (double)from_real(slope.at[0]) / unit / first;
        const double found = (double)from_real(f.at[0]) / ldexp(1, f.exponent);
        const double bent = (double)from_real(curve.at[0]) / ldexp(1, curve.exponent);
        TEST_ASSERT_FLOAT_WITHIN(2e-3F, 1, (float)scale);
        TEST_ASSERT_FLOAT_WITHIN(2e-3F, 1, (float)(found / value));
        if (order > 1) TEST_ASSERT_FLOAT_WITHIN(2e-3F, 1, (float)(bent / second));
    }
}

static void what_is_above_all_eigenvalues_is_told(void)
{
    static const double off[] = {1e-4, 1e-3, 1e-2, 0.1, 0.5};
    rng r = rng_seed(505);
    for (int n = 0; n < 500; n++) {
        random_band(&r, 1 + n % 13, n % 2 ? 0.5F : 0.01F);
        (void)divide_by_norm(band, order);
        read_band();
        const double largest = eigenvalue_below(0);
        for (int k = 0; k < 5; k++) {
            const real above = to_real((float)(largest + off[k])),
                       below = to_real((float)(largest - off[k]));
            TEST_ASSERT_TRUE(is_above_all(band, order, above));
            TEST_ASSERT_FALSE(is_above_all(band, order, below));
        }
        for (int k = 1; k < order; k++) { /* between two of them, and below */
            const double middle = (eigenvalue_below(k - 1) + eigenvalue_below(k)) / 2;
            if (eigenvalue_below(k - 1) - middle < 1e-4) continue;
            TEST_ASSERT_FALSE(is_above_all(band, order, to_real((float)middle)));
        }
    }
}

/* Two sweeps: the eigenvalue goes to the head, nothing is left beside it, and the rest has the other ones. */
static void sweeps_split_the_eigenvalue_off(void)
{
    rng r = rng_seed(506);
    for (int n = 0; n < 300; n++) {
        edml_plane_rotation done[MOST];
        double others[MOST];
        random_band(&r, 3 + n % 11, 0.5F);
        (void)divide_by_norm(band, order);
        read_band();
        const double largest = eigenvalue_below(0);
        if (largest - eigenvalue_below(1) < 0.05) continue;
        for (int k = 1; k < order; k++) others[k] = eigenvalue_below(k);
        memory[0] = to_real(0.5F);
        for (int k = 0; k < 2; k++) { /* one is usual */
            const double was = (double)from_real(memory[0]);
            sweep(done, band, order, to_real((float)largest));
            const double turned = was * (double)from_real(done[order - 2].cosine);
            TEST_ASSERT_FLOAT_WITHIN((float)NUMBER_TOLERANCE, (float)turned, from_real(memory[0]));
        }
        TEST_ASSERT_FLOAT_WITHIN(1e-3F, (float)largest, from_real(band[0]));
        TEST_ASSERT_FLOAT_WITHIN(2e-3F, 0, from_real(band[1]));
        for (int i = 0; i < order - 1; i++) {
            const double c = (double)from_real(done[i].cosine), s = (double)from_real(done[i].sine);
            TEST_ASSERT_FLOAT_WITHIN(1e-6F, 1, (float)(c * c + s * s));
        }
        memmove(band, band + 2, LENGTH - 2 * sizeof *band);
        order--;
        read_band();
        for (int k = 0; k < order; k++)
            TEST_ASSERT_FLOAT_WITHIN(1e-3F, (float)others[k + 1], (float)eigenvalue_below(k));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_band_is_divided_by_its_norm);
    RUN_TEST(the_largest_eigenvalue_is_found);
    RUN_TEST(a_few_steps_are_enough);
    RUN_TEST(the_characteristic_polynomial_has_its_derivatives);
    RUN_TEST(what_is_above_all_eigenvalues_is_told);
    RUN_TEST(sweeps_split_the_eigenvalue_off);
    return UNITY_END();
}
