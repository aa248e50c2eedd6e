/* lift/edm.h: normalised distances in the image, and what is refused.
 *
 * SPDX-License-Identifier: MIT
 */
#include <float.h>

#include "helpers.h"

enum { FEWEST = 10 };
static const float WIDEST = 6.5F;

static edml_keypoint in[EDML_JOINTS];
static float edm[EDML_PAIRS], again[EDML_PAIRS];

/* A person on whole pixels: sums, differences and halves are then exact. */
static void whole_pixels(rng *r)
{
    edml_point x[EDML_JOINTS];
    random_human(r, x);
    photograph(in, x);
    for (int j = 0; j < EDML_JOINTS; j++) {
        in[j].x = floorf(in[j].x);
        in[j].y = floorf(in[j].y);
    }
}

static void someone(void)
{
    edml_point x[EDML_JOINTS];
    human_pose(x);
    photograph(in, x);
}

static edml_status run(float out[EDML_PAIRS]) { return edml_edm(out, in, FEWEST, WIDEST, NULL); }

static edml_status run_imputed(float out[EDML_PAIRS])
{
    return edml_edm(out, in, 1, WIDEST, &edml_default_imputation);
}

/* in -> a x + b, per axis */
static void map(float ax, float bx, float ay, float by)
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        in[j].x = ax * in[j].x + bx;
        in[j].y = ay * in[j].y + by;
    }
}

static float worst_difference(void)
{
    float worst = 0;
    for (int n = 0; n < EDML_PAIRS; n++)
        if (fabsf(edm[n] - again[n]) > worst) worst = fabsf(edm[n] - again[n]);
    return worst;
}

/* ---- Values ---------------------------------------------------------------------------------- */

static void values_are_distances_over_half_the_height(void)
{
    rng r = rng_seed(1);
    for (int n = 0; n < 50; n++) {
        whole_pixels(&r);
        double top = (double)in[0].y, bottom = top;
        for (int j = 0; j < EDML_JOINTS; j++) {
            top = fmin(top, (double)in[j].y);
            bottom = fmax(bottom, (double)in[j].y);
        }
        TEST_ASSERT_EQUAL_INT(EDML_OK, run(edm));
        for (int i = 0; i < EDML_JOINTS; i++)
            for (int j = i + 1; j < EDML_JOINTS; j++)
                again[EDML_PAIR(i, j)] = (float)(hypot((double)(in[i].x - in[j].x),
                                                       (double)(in[i].y - in[j].y)) /
                                                 ((bottom - top) / 2));
        TEST_ASSERT_ERROR_UP_TO(EDM_TOLERANCE, worst_difference());
    }
}

static void joints_one_above_the_other_at_the_extremes_are_exactly_2_apart(void)
{
    someone();
    in[EDML_HEAD].x = in[EDML_L_ANKLE].x;
    TEST_ASSERT_EQUAL_INT(EDML_OK, run(edm));
    TEST_ASSERT_TRUE(edm[EDML_PAIR(EDML_HEAD, EDML_L_ANKLE)] == 2.0F);
}

/* The 91 values stand for a symmetric matrix: swapping joints swaps rows and columns. */
static void swapping_joints_swaps_values_bit_for_bit(void)
{
    rng r = rng_seed(2);
    whole_pixels(&r);
    TEST_ASSERT_EQUAL_INT(EDML_OK, run(edm));
    edml_keypoint was[EDML_JOINTS];
    memcpy(was, in, sizeof was);
    for (int j = 0; j < EDML_JOINTS; j++) in[j] = was[EDML_JOINTS - 1 - j];
    TEST_ASSERT_EQUAL_INT(EDML_OK, run(again));
    for (int i = 0; i < EDML_JOINTS; i++)
        for (int j = i + 1; j < EDML_JOINTS; j++)
            TEST_ASSERT_TRUE(edm[EDML_PAIR(i, j)] ==
                             again[EDML_PAIR(EDML_JOINTS - 1 - j, EDML_JOINTS - 1 - i)]);
}

static void pairs_with_a_missing_joint_are_zero_and_others_stay(void)
{
    someone(); /* neither wrist is the highest or the lowest joint */
    TEST_ASSERT_EQUAL_INT(EDML_OK, run(edm));
    in[EDML_R_WRIST].c = 0;
    TEST_ASSERT_EQUAL_INT(EDML_OK, run(again));
    for (int i = 0; i < EDML_JOINTS; i++) {
        for (int j = i + 1; j < EDML_JOINTS; j++) {
            const int missing = i == EDML_R_WRIST || j == EDML_R_WRIST;
            TEST_ASSERT_TRUE(again[EDML_PAIR(i, j)] == (missing ? 0.0F : edm[EDML_PAIR(i, j)]));
        }
    }
}

static void a_missing_joints_coordinates_do_not_matter(void)
{
    static const float garbage[] = {NAN, INFINITY, -INFINITY, 3e38F, -1e30F, 1e-40F};
    someone();
    in[EDML_L_KNEE].c = -1;
    TEST_ASSERT_EQUAL_INT(EDML_OK, run(edm));
    for (unsigned n = 0; n < sizeof garbage / sizeof *garbage; n++) {
        in[EDML_L_KNEE].x = garbage[n];
        in[EDML_L_KNEE].y = garbage[n];
        TEST_ASSERT_EQUAL_INT(EDML_OK, run(again));
        TEST_ASSERT_SAME_BYTES(edm, again);
    }
}

static void how_confident_does_not_matter(void)
{
    someone();
    TEST_ASSERT_EQUAL_INT(EDML_OK, run(edm));
    for (int j = 0; j < EDML_JOINTS; j++) in[j].c = j % 2 ? 1e-40F : 3e38F;
    TEST_ASSERT_EQUAL_INT(EDML_OK, run(again));
    TEST_ASSERT_SAME_BYTES(edm, again);
}

/* ---- Joints that are guessed ------------------------------------------------------------------ */

static void hide(int count, rng *r)
{
    while (count > 0) {
        const int j = (int)(rng_bits(r) % EDML_JOINTS);
        count -= in[j].c > 0;
        in[j].c = 0;
    }
}

static void seen_joints_need_no_guess(void)
{
    rng r = rng_seed(5);
    for (int n = 0; n < 50; n++) {
        whole_pixels(&r);
        TEST_ASSERT_EQUAL_INT(EDML_OK, run(edm));
        TEST_ASSERT_EQUAL_INT(EDML_OK, run_imputed(again));
        TEST_ASSERT_SAME_BYTES(edm, again);
        hide(1 + n % 4, &r);
        TEST_ASSERT_EQUAL_INT(EDML_OK, run(edm));
        TEST_ASSERT_EQUAL_INT(EDML_OK, run_imputed(again));
        for (int i = 0; i < EDML_JOINTS; i++)
            for (int j = i + 1; j < EDML_JOINTS; j++) {
                const float was = edm[EDML_PAIR(i, j)], is = again[EDML_PAIR(i, j)];
                TEST_ASSERT_TRUE(in[i].c > 0 && in[j].c > 0 ? is == was : was == 0.0F && is > 0.0F);
            }
    }
}

/* Where all guessed joints are at the weighted means of all others, it matters not that they were
 * guessed.  They are brought there one after the other, again and again. */
static void a_guess_is_at_the_weighted_mean_of_the_others(void)
{
    rng r = rng_seed(6);
    for (int n = 0; n < 40; n++) {
        whole_pixels(&r);
        edml_keypoint all[EDML_JOINTS];
        hide(1 + n % 4, &r);
        memcpy(all, in, sizeof all);
        for (int round = 0; round < 200; round++) {
            for (int j = 0; j < EDML_JOINTS; j++) {
                if (in[j].c > 0) continue;
                double x = 0, y = 0;
                for (int i = 0; i < EDML_JOINTS; i++) {
                    x += (double)all[i].x * edml_default_imputation.weight[j][i] / EDML_IMPUTATION_ONE;
                    y += (double)all[i].y * edml_default_imputation.weight[j][i] / EDML_IMPUTATION_ONE;
                }
                all[j].x = (float)x;
                all[j].y = (float)y;
            }
        }
        TEST_ASSERT_EQUAL_INT(EDML_OK, run_imputed(edm));
        double top = 1e9, bottom = -1e9; /* of the seen ones */
        for (int j = 0; j < EDML_JOINTS; j++) {
            if (in[j].c > 0) top = fmin(top, (double)in[j].y);
            if (in[j].c > 0) bottom = fmax(bottom, (double)in[j].y);
        }
        for (int i = 0; i < EDML_JOINTS; i++)
            for (int j = i + 1; j < EDML_JOINTS; j++)
                again[EDML_PAIR(i, j)] = (float)(hypot((double)(all[i].x - all[j].x),
                                                       (double)(all[i].y - all[j].y)) /
                                                 ((bottom - top) / 2));
        TEST_ASSERT_ERROR_UP_TO(EDM_GUESSED_TOLERANCE, worst_difference());
    }
}

static void weights_of_a_guess_add_up_to_one_and_are_the_same_for_left_and_right(void)
{
    for (int i = 0; i < EDML_JOINTS; i++) {
        int sum = 0;
        for (int j = 0; j < EDML_JOINTS; j++) {
            sum += edml_default_imputation.weight[i][j];
            TEST_ASSERT_EQUAL_INT(
                edml_default_imputation.weight[i][j],
                edml_default_imputation.weight[edml_mirror_joint[i]][edml_mirror_joint[j]]);
        }
        TEST_ASSERT_EQUAL_INT(EDML_IMPUTATION_ONE, sum);
        TEST_ASSERT_EQUAL_INT(0, edml_default_imputation.weight[i][i]);
    }
}

static void guesses_turn_with_the_image(void)
{
    rng r = rng_seed(7);
    for (int n = 0; n < 20; n++) {
        whole_pixels(&r);
        hide(4, &r);
        TEST_ASSERT_EQUAL_INT(EDML_OK, run_imputed(edm));
        map(-1, 0, 1, 0);
        TEST_ASSERT_EQUAL_INT(EDML_OK, run_imputed(again));
        TEST_ASSERT_SAME_BYTES(edm, again);
        float width[2] = {1e9F, -1e9F}, height[2] = {1e9F, -1e9F};
        for (int j = 0; j < EDML_JOINTS; j++) {
            const edml_keypoint k = in[j];
            in[j].x = k.y;
            in[j].y = -k.x;
            if (!(k.c > 0)) continue;
            width[0] = fminf(width[0], k.x);
            width[1] = fmaxf(width[1], k.x);
            height[0] = fminf(height[0], k.y);
            height[1] = fmaxf(height[1], k.y);
        }
        const float ratio = (height[1] - height[0]) / (width[1] - width[0]);
        if (ratio > WIDEST || run_imputed(again) != EDML_OK) continue;
        for (int k = 0; k < EDML_PAIRS; k++) again[k] /= ratio;
        TEST_ASSERT_ERROR_UP_TO(EDM_GUESSED_TOLERANCE, worst_difference());
    }
}

static void what_is_not_seen_does_not_matter_to_a_guess(void)
{
    static const float garbage[] = {NAN, INFINITY, 3e38F, -1e30F};
    someone();
    in[EDML_L_KNEE].c = in[EDML_L_ANKLE].c = 0;
    TEST_ASSERT_EQUAL_INT(EDML_OK, run_imputed(edm));
    for (unsigned n = 0; n < sizeof garbage / sizeof *garbage; n++) {
        in[EDML_L_KNEE].x = in[EDML_L_ANKLE].y = garbage[n];
        TEST_ASSERT_EQUAL_INT(EDML_OK, run_imputed(again));
        TEST_ASSERT_SAME_BYTES(edm, again);
    }
}

static void up_to_nine_joints_are_guessed(void)
{
    someone();
    for (int j = 5; j < EDML_JOINTS; j++) in[j].c = 0;
    TEST_ASSERT_EQUAL_INT(EDML_OK, run_imputed(edm));
    TEST_ASSERT_TRUE(all_finite(edm, EDML_PAIRS));
    in[EDML_R_WRIST].c = 0;
    memcpy(again, edm, sizeof again);
    TEST_ASSERT_EQUAL_INT(EDML_ERR_TOO_FEW_JOINTS, run_imputed(edm));
    TEST_ASSERT_SAME_BYTES(again, edm);
}

/* ---- Invariance ------------------------------------------------------------------------------ */

static void check_same_after(float ax, float bx, float ay, float by)
{
    rng r = rng_seed(3);
    for (int n = 0; n < 20; n++) {
        whole_pixels(&r);
        TEST_ASSERT_EQUAL_INT(EDML_OK, run(edm));
        map(ax, bx, ay, by);
        TEST_ASSERT_EQUAL_INT(EDML_OK, run(again));
        TEST_ASSERT_SAME_BYTES(edm, again);
    }
}

static void moving_the_image_changes_no_bit(void)
{
    check_same_after(1, 1234, 1, -777);
    check_same_after(1, 100000, 1, 300000); /* pixels are still whole in float32 */
}

static void scaling_the_image_by_a_power_of_two_changes_no_bit(void)
{
    check_same_after(0.125F, 0, 0.125F, 0);
    check_same_after(ldexpf(1, 100), 0, ldexpf(1, 100), 0);
    check_same_after(ldexpf(1, -100), 0, ldexpf(1, -100), 0);
}

static void turning_the_image_upside_down_changes_no_bit(void) { check_same_after(-1, 0, -1, 0); }

static void mirroring_the_image_changes_no_bit(void)
{
    check_same_after(-1, 0, 1, 0);
    check_same_after(1, 0, -1, 0);
}

static void scaling_the_image_changes_rounding_only(void)
{
    rng r = rng_seed(4);
    for (int n = 0; n < 50; n++) {
        whole_pixels(&r);
        TEST_ASSERT_EQUAL_INT(EDML_OK, run(edm));
        const float scale = uniform(&r, 0.01F, 100);
        map(scale, 0, scale, 0);
        TEST_ASSERT_EQUAL_INT(EDML_OK, run(again));
        TEST_ASSERT_ERROR_UP_TO(EDM_SCALED_TOLERANCE, worst_difference());
    }
}

/* ---- Refusals -------------------------------------------------------------------------------- */

static void check(edml_status expected) { TEST_ASSERT_EQUAL_INT(expected, run(edm)); }

static void not_finite_is_refused_in_each_member_of_each_joint(void)
{
    static const float bad[] = {NAN, INFINITY, -INFINITY};
    for (int j = 0; j < EDML_JOINTS; j++) {
        for (int n = 0; n < 9; n++) {
            someone();
            float *member = n / 3 == 0 ? &in[j].x : n / 3 == 1 ? &in[j].y : &in[j].c;
            *member = bad[n % 3];
            check(EDML_ERR_NOT_FINITE);
        }
    }
}

static void fewer_than_the_fewest_joints_are_refused(void)
{
    someone();
    for (int j = 0; j < EDML_JOINTS - FEWEST; j++) in[2 + j].c = 0;
    check(EDML_OK);
    in[EDML_HEAD].c = 0;
    check(EDML_ERR_TOO_FEW_JOINTS);
    for (int j = 0; j < EDML_JOINTS; j++) in[j].c = -0.0F;
    check(EDML_ERR_TOO_FEW_JOINTS);
}

static void equal_points_are_refused(void)
{
    someone();
    map(0, 320, 0, 240);
    check(EDML_ERR_DEGENERATE);
    map(0, 0, 0, 0);
    check(EDML_ERR_DEGENERATE);
}

static void points_without_height_are_refused(void)
{
    someone();
    map(1, 0, 0, 240);
    check(EDML_ERR_DEGENERATE);
}

static void points_on_a_line_are_refused(void)
{
    for (int slope = -4; slope <= 4; slope++) { /* vertical at 0 */
        someone();
        for (int j = 0; j < EDML_JOINTS; j++) in[j].x = (float)slope * 0.5F * in[j].y;
        check(EDML_ERR_DEGENERATE);
    }
}

static void points_nearly_on_a_line_are_refused_and_a_narrow_person_is_not(void)
{
    someone();
    map(1.0F / 100, 0, 1, 0); /* a person's spread is about three times as high as wide */
    check(EDML_ERR_DEGENERATE);
    someone();
    map(1.0F / 8, 0, 1, 0);
    check(EDML_OK);
}

static void a_person_lost_in_the_rounding_of_far_coordinates_is_refused(void)
{
    someone(); /* 330 pixels high */
    map(1, 1e6F, 1, 0);
    check(EDML_ERR_DEGENERATE);
    someone();
    map(1, 0, 1, -1e6F);
    check(EDML_ERR_DEGENERATE);
    someone();
    map(1, -1e6F, 1, 0);
    check(EDML_ERR_DEGENERATE);
    someone();
    map(1, 0, 1, 1e6F);
    check(EDML_ERR_DEGENERATE);
    someone();
    map(1, 1e5F, 1, 1e5F);
    check(EDML_OK);
}

/* Where floats lose bits to being small. */
static void a_person_smaller_than_the_least_number_with_all_its_bits_is_refused(void)
{
    someone();
    map(0x1p-120F, 0, 0x1p-120F, 0);
    check(EDML_OK);
    map(0x1p-34F, 0, 0x1p-34F, 0);
    check(EDML_ERR_DEGENERATE);
}

static void wider_than_the_widest_is_refused(void)
{
    someone();
    map(40, 0, 1, 0);
    check(EDML_ERR_ASPECT);
}

static void coordinates_whose_differences_overflow_are_measured(void)
{
    someone();
    in[EDML_L_WRIST].x = in[EDML_L_WRIST].y = 3e38F;
    in[EDML_R_WRIST].x = -3e38F;
    TEST_ASSERT_EQUAL_INT(EDML_OK, run(edm)); /* the others are a point between the two wrists */
    const float wrists = edm[EDML_PAIR(EDML_R_WRIST, EDML_L_WRIST)];
    TEST_ASSERT_FLOAT_WITHIN(1e-5F, 2 * sqrtf(4 + 1), wrists);
}

/* However large or small: a status in range, and finite values with EDML_OK. */
static void extreme_coordinates_give_finite_values_or_a_refusal(void)
{
    static const float size[] = {1e30F, 3e35F, 1e-30F, FLT_MIN, 1e-40F, 1e-43F};
    for (unsigned n = 0; n < sizeof size / sizeof *size; n++) {
        someone();
        map(size[n], 0, size[n], 0);
        const edml_status status = run(edm);
        TEST_ASSERT_TRUE(status == EDML_OK || status == EDML_ERR_DEGENERATE || status == EDML_ERR_ASPECT);
        if (status != EDML_OK) continue;
        TEST_ASSERT_TRUE(all_finite(edm, EDML_PAIRS));
        for (int k = 0; k < EDML_PAIRS; k++) TEST_ASSERT_TRUE(edm[k] >= 0 && edm[k] <= 2 * WIDEST + 2);
    }
}

/* "A function that can fail returns a status and then leaves its outputs untouched." */
static void output_stays_untouched_when_refused(void)
{
    memset(again, 0xA5, sizeof again);
    memset(edm, 0xA5, sizeof edm);
    someone();
    in[3].x = NAN;
    check(EDML_ERR_NOT_FINITE);
    TEST_ASSERT_SAME_BYTES(again, edm);
    someone();
    for (int j = 0; j < 5; j++) in[j].c = 0;
    check(EDML_ERR_TOO_FEW_JOINTS);
    TEST_ASSERT_SAME_BYTES(again, edm);
    someone();
    map(1, 0, 0, 0); /* no height */
    check(EDML_ERR_DEGENERATE);
    TEST_ASSERT_SAME_BYTES(again, edm);
    someone();
    map(0, 0, 1, 0); /* no width: on a line */
    check(EDML_ERR_DEGENERATE);
    TEST_ASSERT_SAME_BYTES(again, edm);
    someone();
    map(40, 0, 1, 0);
    check(EDML_ERR_ASPECT);
    TEST_ASSERT_SAME_BYTES(again, edm);
    TEST_ASSERT_EQUAL_INT(EDML_ERR_ARGUMENT, edml_edm(NULL, in, FEWEST, WIDEST, NULL));
    TEST_ASSERT_EQUAL_INT(EDML_ERR_ARGUMENT, edml_edm(edm, NULL, FEWEST, WIDEST, NULL));
    TEST_ASSERT_SAME_BYTES(again, edm);
}

/* Two joints that are each expected where the other one is. */
static void an_imputation_that_goes_round_in_a_circle_is_refused(void)
{
    edml_imputation circle = edml_default_imputation;
    memset(circle.weight[EDML_R_ELBOW], 0, sizeof circle.weight[0]);
    memset(circle.weight[EDML_R_WRIST], 0, sizeof circle.weight[0]);
    circle.weight[EDML_R_ELBOW][EDML_R_WRIST] = EDML_IMPUTATION_ONE;
    circle.weight[EDML_R_WRIST][EDML_R_ELBOW] = EDML_IMPUTATION_ONE;
    someone();
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_edm(edm, in, FEWEST, WIDEST, &circle));
    in[EDML_R_ELBOW].c = in[EDML_R_WRIST].c = 0;
    TEST_ASSERT_EQUAL_INT(EDML_ERR_DEGENERATE, edml_edm(edm, in, FEWEST, WIDEST, &circle));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(values_are_distances_over_half_the_height);
    RUN_TEST(joints_one_above_the_other_at_the_extremes_are_exactly_2_apart);
    RUN_TEST(swapping_joints_swaps_values_bit_for_bit);
    RUN_TEST(pairs_with_a_missing_joint_are_zero_and_others_stay);
    RUN_TEST(a_missing_joints_coordinates_do_not_matter);
    RUN_TEST(how_confident_does_not_matter);
    RUN_TEST(seen_joints_need_no_guess);
    RUN_TEST(a_guess_is_at_the_weighted_mean_of_the_others);
    RUN_TEST(weights_of_a_guess_add_up_to_one_and_are_the_same_for_left_and_right);
    RUN_TEST(guesses_turn_with_the_image);
    RUN_TEST(what_is_not_seen_does_not_matter_to_a_guess);
    RUN_TEST(up_to_nine_joints_are_guessed);
    RUN_TEST(moving_the_image_changes_no_bit);
    RUN_TEST(scaling_the_image_by_a_power_of_two_changes_no_bit);
    RUN_TEST(turning_the_image_upside_down_changes_no_bit);
    RUN_TEST(mirroring_the_image_changes_no_bit);
    RUN_TEST(scaling_the_image_changes_rounding_only);
    RUN_TEST(not_finite_is_refused_in_each_member_of_each_joint);
    RUN_TEST(fewer_than_the_fewest_joints_are_refused);
    RUN_TEST(equal_points_are_refused);
    RUN_TEST(points_without_height_are_refused);
    RUN_TEST(points_on_a_line_are_refused);
    RUN_TEST(points_nearly_on_a_line_are_refused_and_a_narrow_person_is_not);
    RUN_TEST(a_person_lost_in_the_rounding_of_far_coordinates_is_refused);
    RUN_TEST(a_person_smaller_than_the_least_number_with_all_its_bits_is_refused);
    RUN_TEST(wider_than_the_widest_is_refused);
    RUN_TEST(coordinates_whose_differences_overflow_are_measured);
    RUN_TEST(extreme_coordinates_give_finite_values_or_a_refusal);
    RUN_TEST(output_stays_untouched_when_refused);
    RUN_TEST(an_imputation_that_goes_round_in_a_circle_is_refused);
    return UNITY_END();
}
