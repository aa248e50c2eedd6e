/* network/: FConn in float and in integers, and models.  The float one's values are
 * compared with NumPy's in test_vectors.c.
 *
 * SPDX-License-Identifier: MIT
 */
#include "helpers.h"
#include "network/kernels.h" /* to make models of our own: what a generated header fills in */

EDML_KERNEL(fconn, f32);
EDML_KERNEL(fconn, w16);
EDML_KERNEL(fconn, w8);
EDML_KERNEL(equivariant, f32);
EDML_KERNEL(equivariant, w16);
EDML_KERNEL(equivariant, w8);

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
        edml_predict(distance, edm, &edml_fconn_f32, &work, sizeof work);
        TEST_ASSERT_TRUE(all_finite(distance, EDML_PAIRS));
        for (int n = 0; n < EDML_PAIRS; n++) TEST_ASSERT_TRUE(distance[n] >= 0);
    }
}

static void what_work_memory_held_does_not_matter(void)
{
    fill_edm(1);
    memset(&work, 0, sizeof work);
    edml_predict(distance, edm, &edml_fconn_f32, &work, sizeof work);
    memset(&work, 0xFF, sizeof work); /* NaN */
    edml_predict(again, edm, &edml_fconn_f32, &work, sizeof work);
    TEST_ASSERT_SAME_BYTES(distance, again);
}

static void the_input_is_left_alone(void)
{
    float was[EDML_PAIRS];
    fill_edm(2);
    memcpy(was, edm, sizeof was);
    edml_predict(distance, edm, &edml_fconn_f32, &work, sizeof work);
    TEST_ASSERT_SAME_BYTES(was, edm);
}

/* ---- Networks of our own ----------------------------------------------------------------------- */

enum { GROUPS = (EDML_PAIRS + EDML_ROWS - 1) / EDML_ROWS };

static float weight[GROUPS][EDML_PAIRS][EDML_ROWS], bias[GROUPS * EDML_ROWS];
static edml_dense_f32 layers[2];

/* `count` layers y_n = relu(scale x_n + bias_n); scale and biases are powers of two or small
 * integers, so that results are exact. */
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
    model.predict_f32 = edml__fconn_f32;
    model.compute_checksum = edml__fconn_checksum_f32;
    model.layers = layers;
    model.layer_count = (uint8_t)count;
    model.checksum = model.compute_checksum(&model);
    return model;
}

static void a_layer_is_weight_times_input_plus_bias(void)
{
    for (int n = 0; n < EDML_PAIRS; n++) edm[n] = (float)(n % 7) * 0.25F;
    const edml_model model = diagonal_model(2, 1, 1);
    edml_predict(distance, edm, &model, &work, sizeof work);
    for (int n = 0; n < EDML_PAIRS; n++) TEST_ASSERT_TRUE(distance[n] == 2 * edm[n] + (float)n);
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
    edml_predict(distance, edm, &model, &work, sizeof work);
    for (int n = 0; n < EDML_PAIRS; n++) TEST_ASSERT_TRUE(distance[n] == (n == 3 ? (float)sum : 0.0F));
}

static void negative_sums_become_zero(void)
{
    for (int n = 0; n < EDML_PAIRS; n++) edm[n] = 40;
    const edml_model model = diagonal_model(1, -1, 1);
    edml_predict(distance, edm, &model, &work, sizeof work);
    for (int n = 0; n < EDML_PAIRS; n++) TEST_ASSERT_TRUE(distance[n] == (n < 40 ? (float)(40 - n) : 0.0F));
}

static void layers_follow_one_another(void)
{
    for (int n = 0; n < EDML_PAIRS; n++) edm[n] = (float)n;
    const edml_model model = diagonal_model(2, 1, 2);
    edml_predict(distance, edm, &model, &work, sizeof work);
    for (int n = 0; n < EDML_PAIRS; n++) TEST_ASSERT_TRUE(distance[n] == (float)(4 * n + 3 * n));
}

/* ---- Integers, against model.h's definition written plainly -------------------------------- */

enum { WIDE = EDML_MAX_UNITS, HIGHEST = 127 << 24 };

static edml_work_q work_q24;
static int32_t edm_q24[EDML_PAIRS], distance_q24[EDML_PAIRS], wanted_q24[EDML_PAIRS];

static int is_equivariant(const edml_model *model)
{
    return model->predict_q == edml__equivariant_w16 || model->predict_q == edml__equivariant_w8;
}

static int is_w16(const edml_model *model)
{
    return model->predict_q == edml__fconn_w16 || model->predict_q == edml__equivariant_w16;
}

/* Layer n of a quantised model; one of 8 bits gets weights of 16 from the caller. */
static edml_dense_w16 wide_layer(const edml_model *model, int n, int16_t wide[WIDE * WIDE])
{
    if (is_w16(model)) return ((const edml_dense_w16 *)model->layers)[n];
    const edml_dense_w8 *narrow = &((const edml_dense_w8 *)model->layers)[n];
    const int count = (narrow->outputs + EDML_ROWS - 1) / EDML_ROWS * EDML_ROWS * narrow->inputs;
    for (int k = 0; k < count; k++) wide[k] = narrow->weight[k];
    const edml_dense_w16 layer = {narrow->inputs,     narrow->outputs, wide,         narrow->bias,
                                  narrow->multiplier, narrow->shift,   narrow->clamp};
    return layer;
}

/* floor(value / 2^shift), limited */
static int64_t scaled_down(int64_t value, int shift, int64_t limit)
{
    if (value < 0) return 0;
    return value >> shift < limit ? value >> shift : limit;
}

static int64_t weight_of(const edml_dense_w16 *layer, int row, int input)
{
    return layer->weight[(row / 8 * layer->inputs + input) * 8 + row % 8];
}

static int64_t activated(int64_t sum, const edml_dense_w16 *layer, int row)
{
    const int64_t half = (int64_t)1 << (layer->shift - 1);
    TEST_ASSERT_TRUE(INT32_MIN <= sum && sum <= INT32_MAX);
    return scaled_down(sum * layer->multiplier[row] + half, layer->shift, layer->clamp);
}

static int16_t wide_weights[WIDE * WIDE];

static void expect_fconn(const int32_t edm_in[EDML_PAIRS], const edml_model *model)
{
    int64_t x[WIDE], y[WIDE];
    for (int k = 0; k < EDML_PAIRS; k++) x[k] = scaled_down((int64_t)edm_in[k] + 2048, 12, 32767);
    for (int n = 0; n < model->layer_count; n++) {
        const edml_dense_w16 layer = wide_layer(model, n, wide_weights);
        for (int row = 0; row < layer.outputs; row++) {
            int64_t sum = layer.bias[row];
            for (int i = 0; i < layer.inputs; i++) {
                sum += weight_of(&layer, row, i) * x[i];
                TEST_ASSERT_TRUE(INT32_MIN <= sum && sum <= INT32_MAX);
            }
            y[row] = activated(sum, &layer, row);
        }
        memcpy(x, y, sizeof x);
    }
    for (int k = 0; k < EDML_PAIRS; k++) wanted_q24[k] = (int32_t)x[k];
}

/* The pair with left for right. */
static int mirror_pair_of(int i, int j)
{
    const int a = edml_mirror_joint[i], b = edml_mirror_joint[j];
    return a < b ? EDML_PAIR(a, b) : EDML_PAIR(b, a);
}

/* Pairs in their order, the first of two mirror pairs alone; then those that mirror themselves. */
static int first_pairs(int pair[49])
{
    int count = 0;
    for (int own = 0; own < 2; own++)
        for (int i = 0; i < EDML_JOINTS; i++)
            for (int j = i + 1; j < EDML_JOINTS; j++)
                if (own ? EDML_PAIR(i, j) == mirror_pair_of(i, j) : EDML_PAIR(i, j) < mirror_pair_of(i, j))
                    pair[count++] = EDML_PAIR(i, j);
    return count;
}

static int mirror_pair[EDML_PAIRS]; /* of each pair */

static void fill_mirror_pairs(void)
{
    for (int i = 0; i < EDML_JOINTS; i++)
        for (int j = i + 1; j < EDML_JOINTS; j++) mirror_pair[EDML_PAIR(i, j)] = mirror_pair_of(i, j);
}

/* d^2 / (d + 0.6) in Q12, less 3.5. */
static int64_t softened(int32_t q24)
{
    const int64_t d = scaled_down((int64_t)q24 + 2048, 12, 32767), sum = d + 2458;
    return (d * d + sum / 2) / sum - 14336;
}

static void expect_equivariant(const int32_t edm_in[EDML_PAIRS], const edml_model *model)
{
    int64_t x[2][WIDE], y[2][WIDE]; /* first pairs and their mirror pairs */
    int pair[49], count = first_pairs(pair);
    TEST_ASSERT_EQUAL_INT(49, count);
    fill_mirror_pairs();
    for (int k = 0; k < count; k++) {
        x[0][k] = softened(edm_in[pair[k]]);
        x[1][k] = softened(edm_in[mirror_pair[pair[k]]]);
    }
    for (int n = 0; n < model->layer_count; n++) {
        const edml_dense_w16 layer = wide_layer(model, n, wide_weights);
        for (int row = 0; row < layer.outputs; row++) {
            int64_t even = layer.bias[row], odd = 0;
            for (int i = 0; i < count; i++) {
                even += weight_of(&layer, row, i) * (x[0][i] + x[1][i]);
                if (count + i < layer.inputs)
                    odd += weight_of(&layer, row, count + i) * (x[0][i] - x[1][i]);
                TEST_ASSERT_TRUE(INT32_MIN <= even && even <= INT32_MAX);
                TEST_ASSERT_TRUE(INT32_MIN <= odd && odd <= INT32_MAX);
            }
            y[0][row] = activated(even + odd, &layer, row);
            y[1][row] = activated(even - odd, &layer, row);
        }
        memcpy(x, y, sizeof x);
        count = layer.outputs;
    }
    for (int k = 0; k < count; k++) {
        wanted_q24[pair[k]] = (int32_t)x[0][k];
        wanted_q24[mirror_pair[pair[k]]] = (int32_t)x[1][k];
    }
}

static void expect_distances(const int32_t edm_in[EDML_PAIRS], const edml_model *model)
{
    if (is_equivariant(model))
        expect_equivariant(edm_in, model);
    else
        expect_fconn(edm_in, model);
}

/* EDMs of all sizes: first what is likely, then anything, then the extremes. */
enum { EDMS = 40 };
static void fill_edm_q24(int n)
{
    rng r = rng_seed((uint32_t)n);
    for (int k = 0; k < EDML_PAIRS; k++) {
        edm_q24[k] = (int32_t)uniform(&r, 0, n < 20 ? 3 << 24 : (float)HIGHEST);
        if (n == EDMS - 4) edm_q24[k] = 0;
        if (n == EDMS - 3) edm_q24[k] = HIGHEST;
        if (n == EDMS - 2) edm_q24[k] = k % 2 == 0 ? HIGHEST : 0;
        if (n == EDMS - 1) edm_q24[k] = INT32_MAX;
    }
}

/* The model does as defined: between arrays, in place, and in place in its own work memory. */
static void check_against_definition(const edml_model *model)
{
    for (int n = 0; n < EDMS; n++) {
        fill_edm_q24(n);
        expect_distances(edm_q24, model);
        memset(&work_q24, n, sizeof work_q24);
        edml_predict_q(distance_q24, edm_q24, model, &work_q24, sizeof work_q24);
        TEST_ASSERT_SAME_BYTES(wanted_q24, distance_q24);
        memcpy(work_q24.scratch.layer[0], edm_q24, sizeof edm_q24);
        edml_predict_q(distance_q24, work_q24.scratch.layer[0], model, &work_q24, sizeof work_q24);
        TEST_ASSERT_SAME_BYTES(wanted_q24, distance_q24);
        edml_predict_q(edm_q24, edm_q24, model, &work_q24, sizeof work_q24);
        TEST_ASSERT_SAME_BYTES(wanted_q24, edm_q24);
    }
}

static void quantised_models_are_as_defined(void)
{
    check_against_definition(&edml_fconn_w16);
    check_against_definition(&edml_fconn_w8);
}

/* Random layers with sums of up to 31 bits: 128 * 255 * 32767 + 2^30 < 2^31. */
static int16_t weight_w16[2][WIDE * WIDE];
static int8_t weight_w8[2][WIDE * WIDE];
static int32_t bias_q24[2][WIDE], multiplier_q24[2][WIDE];
static edml_dense_w16 layers_w16[2];
static edml_dense_w8 layers_w8[2];

/* A network of one kind and one format. */
typedef struct {
    void (*predict)(int32_t *distance, const int32_t *edm, const edml_model *model, void *scratch);
    uint32_t (*compute_checksum)(const edml_model *model);
    int w16;
    uint16_t units, inputs, outputs; /* the first layer's; the second's */
    int32_t clamp;
} kind;

static const kind fconn_w16 = {edml__fconn_w16, edml__fconn_checksum_w16, 1, 100, 100, EDML_PAIRS, 32767};
static const kind fconn_w8 = {edml__fconn_w8, edml__fconn_checksum_w8, 0, 100, 100, EDML_PAIRS, 32767};
static const kind equivariant_w16 = {
    edml__equivariant_w16, edml__equivariant_checksum_w16, 1, 48, 96, 49, 16383};
static const kind equivariant_w8 = {
    edml__equivariant_w8, edml__equivariant_checksum_w8, 0, 48, 96, 49, 16383};
static const kind *const kinds[] = {&fconn_w16, &fconn_w8, &equivariant_w16, &equivariant_w8};

static edml_model random_model(uint32_t seed, const kind *of)
{
    rng r = rng_seed(seed);
    for (int n = 0; n < 2; n++) {
        const uint16_t inputs = n == 0 ? EDML_PAIRS : of->inputs;
        const uint16_t outputs = n == 0 ? of->units : of->outputs;
        const uint8_t shift = n == 0 ? 44 : 35;
        const int32_t limit = n == 0 ? of->clamp : 3 << 24;
        for (int k = 0; k < WIDE * WIDE; k++) {
            weight_w16[n][k] = (int16_t)((int)(rng_bits(&r) % 511) - 255);
            weight_w8[n][k] = (int8_t)((int)(rng_bits(&r) % 255) - 127);
        }
        for (int k = 0; k < WIDE; k++) {
            bias_q24[n][k] = (int32_t)uniform(&r, -(1 << 29), 1 << 30);
            multiplier_q24[n][k] = k == 0 ? 1 : k == 1 ? INT32_MAX : (int32_t)(rng_bits(&r) >> 1 | 1);
        }
        const edml_dense_w16 w16 = {inputs, outputs, weight_w16[n], bias_q24[n], multiplier_q24[n],
                                    shift,  limit};
        const edml_dense_w8 w8 = {inputs, outputs, weight_w8[n], bias_q24[n], multiplier_q24[n],
                                  shift,  limit};
        layers_w16[n] = w16;
        layers_w8[n] = w8;
    }
    /* Nothing is odd about pairs that mirror themselves. */
    for (int row = 42; of->outputs == 49 && row < 56; row++)
        for (int k = of->inputs / 2; k < of->inputs; k++) {
            const int at = (row / 8 * of->inputs + k) * 8 + row % 8;
            weight_w16[1][at] = 0;
            weight_w8[1][at] = 0;
        }
    edml_model model = edml_fconn_w16;
    model.predict_q = of->predict;
    model.compute_checksum = of->compute_checksum;
    model.layers = of->w16 ? (const void *)layers_w16 : (const void *)layers_w8;
    model.layer_count = 2;
    model.checksum = model.compute_checksum(&model);
    return model;
}

static void random_layers_are_as_defined(void)
{
    for (uint32_t seed = 0; seed < 5; seed++) {
        for (unsigned n = 0; n < sizeof kinds / sizeof *kinds; n++) {
            const edml_model model = random_model(seed, kinds[n]);
            check_against_definition(&model);
        }
    }
}

/* Left and right swapped in the input are swapped in the output, to the last bit. */
static void left_and_right_are_alike(void)
{
    float turned[EDML_PAIRS];
    fill_mirror_pairs();
    for (uint32_t seed = 0; seed < 20; seed++) {
        const edml_model *const models[] = {&edml_fconn_f32, &edml_fconn_w16, &edml_fconn_w8};
        fill_edm(seed);
        for (int k = 0; k < EDML_PAIRS; k++) turned[k] = edm[mirror_pair[k]];
        for (unsigned n = 0; n < sizeof models / sizeof *models; n++) {
            edml_predict(distance, edm, models[n], &work, sizeof work);
            edml_predict(again, turned, models[n], &work, sizeof work);
            int differ = 0;
            for (int k = 0; k < EDML_PAIRS; k++) {
                TEST_ASSERT_TRUE(again[k] == distance[mirror_pair[k]]);
                differ += again[k] != distance[k];
            }
            TEST_ASSERT_TRUE(differ > EDML_PAIRS / 2);
        }
    }
}

/* One layer y_n = (sum_n multiplier + half) >> shift, sum_n = x_n + offset. */
static edml_model identity_w16(int32_t offset, int32_t multiplier, uint8_t shift, int32_t clamp)
{
    memset(weight_w16[0], 0, sizeof weight_w16[0]);
    for (int n = 0; n < EDML_PAIRS; n++) {
        weight_w16[0][n / EDML_ROWS * EDML_ROWS * EDML_PAIRS + n * EDML_ROWS + n % EDML_ROWS] = 1;
        bias_q24[0][n] = offset;
        multiplier_q24[0][n] = multiplier;
    }
    const edml_dense_w16 layer = {EDML_PAIRS,        EDML_PAIRS, weight_w16[0], bias_q24[0],
                                  multiplier_q24[0], shift,      clamp};
    layers_w16[0] = layer;
    edml_model model = edml_fconn_w16;
    model.predict_q = edml__fconn_w16;
    model.layers = layers_w16;
    model.layer_count = 1;
    return model;
}

static int32_t first_distance(const edml_model *model, int32_t edm_value)
{
    for (int k = 0; k < EDML_PAIRS; k++) edm_q24[k] = edm_value;
    edml_predict_q(distance_q24, edm_q24, model, &work_q24, sizeof work_q24);
    for (int k = 1; k < EDML_PAIRS; k++) TEST_ASSERT_EQUAL_INT32(distance_q24[0], distance_q24[k]);
    return distance_q24[0];
}

static void integers_are_rounded_to_nearest(void)
{
    const edml_model input = identity_w16(0, 2, 1, 3 << 24); /* y = x */
    TEST_ASSERT_EQUAL_INT32(0, first_distance(&input, 2047));
    TEST_ASSERT_EQUAL_INT32(1, first_distance(&input, 2048));
    TEST_ASSERT_EQUAL_INT32(1, first_distance(&input, 4096 + 2047));
    const edml_model output = identity_w16(0, 3, 3, 3 << 24); /* y = 3/8 x */
    TEST_ASSERT_EQUAL_INT32(0, first_distance(&output, 1 << 12));
    TEST_ASSERT_EQUAL_INT32(1, first_distance(&output, 2 << 12));
    TEST_ASSERT_EQUAL_INT32(2, first_distance(&output, 4 << 12)); /* a half goes up */
}

static void integers_are_limited(void)
{
    const edml_model wide = identity_w16(0, 2, 1, INT32_MAX);
    TEST_ASSERT_EQUAL_INT32(EDML_ACTIVATION, first_distance(&wide, HIGHEST));
    const edml_model far = identity_w16(INT32_MAX - EDML_ACTIVATION, INT32_MAX, 31, 3 << 24);
    TEST_ASSERT_EQUAL_INT32(3 << 24, first_distance(&far, HIGHEST));
    const edml_model below = identity_w16(INT32_MIN, INT32_MAX, 1, 3 << 24);
    TEST_ASSERT_EQUAL_INT32(0, first_distance(&below, HIGHEST));
    const edml_model tiny = identity_w16(INT32_MAX - EDML_ACTIVATION, INT32_MAX, 62, 3 << 24);
    TEST_ASSERT_EQUAL_INT32(1, first_distance(&tiny, HIGHEST));
}

/* Distances of people, as the float pipeline gets them, in RMS against the float network. */
static float rms_from_float(const edml_model *model)
{
    rng r = rng_seed(5);
    double sum = 0;
    int count = 0;
    for (int n = 0; n < 200; n++) {
        edml_point x[EDML_JOINTS];
        edml_keypoint in[EDML_JOINTS];
        random_human(&r, x);
        photograph(in, x);
        if (edml_edm(edm, in, EDML_JOINTS, 3, NULL) != EDML_OK) continue;
        edml_predict(distance, edm, &edml_fconn_f32, &work, sizeof work);
        memcpy(work.scratch.layer[0], edm, sizeof edm);
        edml_predict(again, work.scratch.layer[0], model, &work, sizeof work); /* as edml_lift() calls it */
        for (int k = 0; k < EDML_PAIRS; k++, count++)
            sum += ((double)again[k] - distance[k]) * ((double)again[k] - distance[k]);
    }
    TEST_ASSERT_TRUE(count > 150 * EDML_PAIRS);
    return (float)sqrt(sum / count);
}

static void quantised_models_are_near_the_float_one(void)
{
    TEST_ASSERT_ERROR_UP_TO(NET_W16_TOLERANCE, rms_from_float(&edml_fconn_w16));
    TEST_ASSERT_ERROR_UP_TO(NET_W8_TOLERANCE, rms_from_float(&edml_fconn_w8));
}

/* ---- Models ------------------------------------------------------------------------------------ */

static void the_models_have_their_names(void)
{
    TEST_ASSERT_EQUAL_STRING("fconn_f32", edml_model_name(&edml_fconn_f32));
    TEST_ASSERT_EQUAL_STRING("fconn_w16", edml_model_name(&edml_fconn_w16));
    TEST_ASSERT_EQUAL_STRING("fconn_w8", edml_model_name(&edml_fconn_w8));
}

static void the_models_are_sound(void)
{
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_model_check(&edml_fconn_f32));
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_model_check(&edml_fconn_w16));
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_model_check(&edml_fconn_w8));
    TEST_ASSERT_EQUAL_INT(EDML_ERR_ARGUMENT, edml_model_check(NULL));
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

static void check_flipped_byte(const edml_model *model, void *byte)
{
    uint8_t *at = byte;
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_model_check(model));
    *at ^= 1;
    TEST_ASSERT_EQUAL_INT(EDML_ERR_MODEL, edml_model_check(model));
    *at ^= 1;
}

static void one_flipped_bit_in_integers_is_noticed(void)
{
    enum { LAST = (EDML_PAIRS + EDML_ROWS - 1) / EDML_ROWS * EDML_ROWS - 1, INPUTS = 100 };
    const edml_model w16 = random_model(7, &fconn_w16);
    check_flipped_byte(&w16, &weight_w16[0][0]);
    check_flipped_byte(&w16, (uint8_t *)&weight_w16[1][(LAST + 1) * INPUTS] - 1);
    check_flipped_byte(&w16, &bias_q24[0][5]);
    check_flipped_byte(&w16, (uint8_t *)&multiplier_q24[1][LAST + 1] - 1);
    const edml_model w8 = random_model(7, &fconn_w8);
    check_flipped_byte(&w8, &weight_w8[0][0]);
    check_flipped_byte(&w8, &weight_w8[1][(LAST + 1) * INPUTS - 1]);
    check_flipped_byte(&w8, &bias_q24[1][LAST]);
    check_flipped_byte(&w8, &multiplier_q24[0][0]);
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
    RUN_TEST(quantised_models_are_as_defined);
    RUN_TEST(random_layers_are_as_defined);
    RUN_TEST(left_and_right_are_alike);
    RUN_TEST(integers_are_rounded_to_nearest);
    RUN_TEST(integers_are_limited);
    RUN_TEST(quantised_models_are_near_the_float_one);
    RUN_TEST(the_models_have_their_names);
    RUN_TEST(the_models_are_sound);
    RUN_TEST(a_wrong_checksum_is_noticed);
    RUN_TEST(one_flipped_bit_in_weight_or_bias_is_noticed);
    RUN_TEST(one_flipped_bit_in_integers_is_noticed);
    return UNITY_END();
}
