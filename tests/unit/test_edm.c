/* lift/edm.h: distances between joints in the image.
 *
 * SPDX-License-Identifier: MIT
 */
#include "as_float.h"

static edml_image image, turned;
static float edm[EDML_PAIRS], again[EDML_PAIRS];

/* Coordinates in all of the range. */
static void fill(rng *r)
{
    memset(&image, 0, sizeof image);
    for (int j = 0; j < EDML_JOINTS; j++) {
        image.at[j].u = uniform(r, -3.9F, 3.9F);
        image.at[j].v = uniform(r, -3.9F, 3.9F);
    }
    image.down.v = 1;
    image.seen = ALL_SEEN;
}

static void values_are_distances(void)
{
    rng r = rng_seed(1);
    for (int n = 0; n < 50; n++) {
        fill(&r);
        edml_edm(edm, &image);
        for (int i = 0; i < EDML_JOINTS; i++)
            for (int j = i + 1; j < EDML_JOINTS; j++)
                TEST_ASSERT_FLOAT_WITHIN(EDM_TOLERANCE,
                                         (float)hypot((double)image.at[i].u - (double)image.at[j].u,
                                                      (double)image.at[i].v - (double)image.at[j].v),
                                         edm[EDML_PAIR(i, j)]);
    }
}

static void joints_in_opposite_corners_are_farthest(void)
{
    rng r = rng_seed(2);
    fill(&r);
    image.at[3].u = image.at[3].v = -3.9F;
    image.at[7].u = image.at[7].v = 3.9F;
    edml_edm(edm, &image);
    TEST_ASSERT_FLOAT_WITHIN(EDM_TOLERANCE, 7.8F * sqrtf(2), edm[EDML_PAIR(3, 7)]);
    image.at[7] = image.at[3];
    edml_edm(edm, &image);
    TEST_ASSERT_TRUE(edm[EDML_PAIR(3, 7)] == 0);
}

/* The 91 values stand for a symmetric matrix: swapping joints swaps rows and columns. */
static void swapping_joints_swaps_values_bit_for_bit(void)
{
    rng r = rng_seed(3);
    fill(&r);
    turned = image;
    for (int j = 0; j < EDML_JOINTS; j++) turned.at[j] = image.at[EDML_JOINTS - 1 - j];
    edml_edm(edm, &image);
    edml_edm(again, &turned);
    for (int i = 0; i < EDML_JOINTS; i++)
        for (int j = i + 1; j < EDML_JOINTS; j++)
            TEST_ASSERT_TRUE(edm[EDML_PAIR(i, j)] ==
                             again[EDML_PAIR(EDML_JOINTS - 1 - j, EDML_JOINTS - 1 - i)]);
}

/* Nor does it matter which joints were seen, and where down is. */
static void quarter_turns_and_mirrors_change_no_bit(void)
{
    rng r = rng_seed(4);
    fill(&r);
    edml_edm(edm, &image);
    for (int n = 0; n < 8; n++) {
        turned = image;
        for (int j = 0; j < EDML_JOINTS; j++) {
            const edml_image_point p = image.at[j];
            const float u = n & 1 ? -p.u : p.u, v = n & 2 ? -p.v : p.v;
            turned.at[j].u = n & 4 ? v : u;
            turned.at[j].v = n & 4 ? u : v;
        }
        turned.seen = (uint16_t)(n * 1234);
        turned.down.u = 1;
        edml_edm(again, &turned);
        TEST_ASSERT_SAME_BYTES(edm, again);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(values_are_distances);
    RUN_TEST(joints_in_opposite_corners_are_farthest);
    RUN_TEST(swapping_joints_swaps_values_bit_for_bit);
    RUN_TEST(quarter_turns_and_mirrors_change_no_bit);
    return UNITY_END();
}
