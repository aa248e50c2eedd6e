/* geometry/angle.h: the arctangent, against libm in double.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>

#include "native.h"
#include "geometry/angle.h"

static const double degree = 3.14159265358979323846 / 180;

static double exactly(real y, real x) /* both as they are rounded */
{
    return atan2((double)y, (double)x) / degree;
}

static double error_of(real y, real x) { return fabs((double)from_api(degrees_of(y, x)) - exactly(y, x)); }

/* Around circles from 1/1000 to 60: each 0.001 degrees on the unit circle, each 0.01 on the others. */
static void a_dense_grid_of_directions(void)
{
    static const double radius[] = {1, 0.001, 0.037, 0.25, 3, 60};
    double worst = 0;
    for (int k = 0; k < 6; k++) {
        const int step = k == 0 ? 1 : 10;
        for (int n = -180000; n <= 180000; n += step) {
            const double angle = n * 0.001 * degree;
            const real y = to_real((float)(radius[k] * sin(angle)));
            const real x = to_real((float)(radius[k] * cos(angle)));
            const double error = error_of(y, x);
            if (error > worst) worst = error;
        }
    }
    printf("arctangent: at most %.2e degrees off\n", worst);
    TEST_ASSERT_TRUE(worst < ARCTANGENT_TOLERANCE);
}

/* Where the octants meet. */
static void around_the_borders_of_octants(void)
{
    static const double border[] = {0, 22.5, 45, 67.5, 90, 112.5, 135, 157.5, 180};
    for (int k = 0; k < 9; k++) {
        for (int n = -2000; n <= 2000; n++) {
            const double angle = (border[k] + n * 1e-6) * degree;
            const real y = to_real((float)sin(angle)), x = to_real((float)cos(angle));
            TEST_ASSERT_TRUE(error_of(y, x) < ARCTANGENT_TOLERANCE);
            TEST_ASSERT_TRUE(error_of(-y, x) < ARCTANGENT_TOLERANCE || (y == 0 && x < 0));
        }
    }
}

static void axes_and_diagonals_are_exact(void)
{
    static const int at[8][3] = {{0, 1, 0},    {1, 1, 45},     {1, 0, 90},   {1, -1, 135},
                                 {0, -1, 180}, {-1, -1, -135}, {-1, 0, -90}, {-1, 1, -45}};
    for (int n = 0; n < 8; n++) {
        const real y = to_real((float)at[n][0]), x = to_real((float)at[n][1]);
        TEST_ASSERT_TRUE(from_api(degrees_of(y, x)) == (float)at[n][2]);
    }
}

static void a_larger_tangent_has_no_smaller_angle(void)
{
    float last = 0;
    for (int n = 0; n <= 200000; n++) {
        const float now = from_api(degrees_of(to_real((float)n / 100000), to_real(1)));
        TEST_ASSERT_TRUE(now > last - 2e-5F);
        if (now > last) last = now;
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_dense_grid_of_directions);
    RUN_TEST(around_the_borders_of_octants);
    RUN_TEST(axes_and_diagonals_are_exact);
    RUN_TEST(a_larger_tangent_has_no_smaller_angle);
    return UNITY_END();
}
