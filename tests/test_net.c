/* fconn_f32.c and model.c: the network.  Its values are compared with NumPy's in test_vectors.c.
 *
 * SPDX-License-Identifier: MIT
 */
#include "helpers.h"
#include "model.h" /* to make models of our own: what a generated header fills in */

static edml_work work;
static float edm[EDML_PAIRS], distance[EDML_PAIRS], again[EDML_PAIRS];

static void fill_edm(uint32_t seed)
{
    rng r = rng_seed(seed);
    for (int n = 0; n < EDML_PAIRS; n++) edm[n] = uniform(&r, 0, 3);
}

static void distances_are_finite_and_not_negative(void)
{
    for (uint32_t seed = 0; seed < 50; seed++) {
        fill_edm(seed);
        if (seed == 0) memset(edm, 0, sizeof edm);
        edml_net_f32(distance, edm, &edml_fconn_f32, &work);
        TEST_ASSERT_TRUE(all_finite(distance, EDML_PAIRS));
        for (int n = 0; n < EDML_PAIRS; n++) TEST_ASSERT_TRUE(distance[n] >= 0);
    }
}

static void what_work_memory_held_does_not_matter(void)
{
    fill_edm(1);
    memset(&work, 0, sizeof work);
    edml_net_f32(distance, edm, &edml_fconn_f32, &work);
    memset(&work, 0xFF, sizeof work); /* NaN */
    edml_net_f32(again, edm, &edml_fconn_f32, &work);
    TEST_ASSERT_SAME_BYTES(distance, again);
}

static void the_input_is_left_alone(void)
{
    float was[EDML_PAIRS];
    fill_edm(2);
    memcpy(was, edm, sizeof was);
    edml_net_f32(distance, edm, &edml_fconn_f32, &work);
    TEST_ASSERT_SAME_BYTES(was, edm);
}

/* ---- Networks of our own ----------------------------------------------------------------------- */

enum { GROUPS = (EDML_PAIRS + EDML_ROWS - 1) / EDML_ROWS };

static float weight[GROUPS][EDML_PAIRS][EDML_ROWS], bias[GROUPS * EDML_ROWS];
static edml_dense_f32 layers[2];

/* `count` layers y_n = relu(scale x_n + bias_n); scale and biases are powers of two or small whole
 * numbers, so that results are exact. */
static edml_model diagonal_model(float scale, float bias0, int count)
{
    memset(weight, 0, sizeof weight);
    for (int n = 0; n < EDML_PAIRS; n++) {
        weight[n / EDML_ROWS][n][n % EDML_ROWS] = scale;
        bias[n] = bias0 * (float)n;
    }
    for (int n = 0; n < 2; n++) {
        layers[n].inputs = layers[n].outputs = EDML_PAIRS;
        layers[n].weight = &weight[0][0][0];
        layers[n].bias = bias;
    }
    edml_model model = edml_fconn_f32;
    model.layers = layers;
    model.layer_count = (uint8_t)count;
    model.checksum = model.hash(&model);
    return model;
}

static void a_layer_is_weight_times_input_plus_bias(void)
{
    for (int n = 0; n < EDML_PAIRS; n++) edm[n] = (float)(n % 7) * 0.25F;
    const edml_model model = diagonal_model(2, 1, 1);
    edml_net_f32(distance, edm, &model, &work);
    for (int n = 0; n < EDML_PAIRS; n++)
        TEST_ASSERT_TRUE(distance[n] == 2 * edm[n] + (float)n);
}

static void a_layer_adds_up_all_inputs(void)
{
    const edml_model model = diagonal_model(0, 0, 1);
    double sum = 0;
    for (int n = 0; n < EDML_PAIRS; n++) {
        edm[n] = (float)n;
        weight[3 / EDML_ROWS][n][3 % EDML_ROWS] = 0.5F;
        sum += 0.5 * n;
    }
    edml_net_f32(distance, edm, &model, &work);
    for (int n = 0; n < EDML_PAIRS; n++)
        TEST_ASSERT_TRUE(distance[n] == (n == 3 ? (float)sum : 0.0F));
}

static void negative_sums_become_zero(void)
{
    for (int n = 0; n < EDML_PAIRS; n++) edm[n] = 40;
    const edml_model model = diagonal_model(1, -1, 1);
    edml_net_f32(distance, edm, &model, &work);
    for (int n = 0; n < EDML_PAIRS; n++)
        TEST_ASSERT_TRUE(distance[n] == (n < 40 ? (float)(40 - n) : 0.0F));
}

static void layers_follow_one_another(void)
{
    for (int n = 0; n < EDML_PAIRS; n++) edm[n] = (float)n;
    const edml_model model = diagonal_model(2, 1, 2);
    edml_net_f32(distance, edm, &model, &work);
    for (int n = 0; n < EDML_PAIRS; n++) TEST_ASSERT_TRUE(distance[n] == (float)(4 * n + 3 * n));
}

/* ---- Models ------------------------------------------------------------------------------------ */

static void the_model_has_its_name(void)
{
    TEST_ASSERT_EQUAL_STRING("fconn_f32", edml_model_name(&edml_fconn_f32));
}

static void the_model_is_sound(void)
{
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_model_check(&edml_fconn_f32));
}

static void a_wrong_checksum_is_noticed(void)
{
    edml_model damaged = edml_fconn_f32;
    damaged.checksum ^= 1;
    TEST_ASSERT_EQUAL_INT(EDML_ERR_MODEL, edml_model_check(&damaged));
}

static void flip_lowest_bit(float *value)
{
    uint32_t word;
    memcpy(&word, value, sizeof word);
    word ^= 1;
    memcpy(value, &word, sizeof word);
}

static void one_flipped_bit_in_weight_or_bias_is_noticed(void)
{
    const edml_model model = diagonal_model(2, 1, 2);
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_model_check(&model));
    flip_lowest_bit(&weight[0][0][0]);
    TEST_ASSERT_EQUAL_INT(EDML_ERR_MODEL, edml_model_check(&model));
    flip_lowest_bit(&weight[0][0][0]);
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_model_check(&model));
    flip_lowest_bit(&weight[GROUPS - 1][EDML_PAIRS - 1][EDML_ROWS - 1]);
    TEST_ASSERT_EQUAL_INT(EDML_ERR_MODEL, edml_model_check(&model));
    flip_lowest_bit(&weight[GROUPS - 1][EDML_PAIRS - 1][EDML_ROWS - 1]);
    flip_lowest_bit(&bias[EDML_PAIRS - 1]);
    TEST_ASSERT_EQUAL_INT(EDML_ERR_MODEL, edml_model_check(&model));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(distances_are_finite_and_not_negative);
    RUN_TEST(what_work_memory_held_does_not_matter);
    RUN_TEST(the_input_is_left_alone);
    RUN_TEST(a_layer_is_weight_times_input_plus_bias);
    RUN_TEST(a_layer_adds_up_all_inputs);
    RUN_TEST(negative_sums_become_zero);
    RUN_TEST(layers_follow_one_another);
    RUN_TEST(the_model_has_its_name);
    RUN_TEST(the_model_is_sound);
    RUN_TEST(a_wrong_checksum_is_noticed);
    RUN_TEST(one_flipped_bit_in_weight_or_bias_is_noticed);
    return UNITY_END();
}
