/* network/: FConn and the equivariant networks in float and in integers, and models.  The shipped ones' values
 * are compared with NumPy's in test_vectors.c.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>

#include "helpers.h"
#include "network/kernels.h" /* to make models of our own: what a generated header fills in */

EDML_KERNEL(fconn, f32);
EDML_KERNEL(fconn, w16);
EDML_KERNEL(fconn, w8);
EDML_KERNEL(equivariant, f32);
EDML_KERNEL(equivariant, w16);
EDML_KERNEL(equivariant, w8);

enum { WIDE = EDML_MAX_UNITS, HIGHEST = 127 << 24, ONE = 1 << 24 };

static edml_work work;
static edml_work_q work_q24;
static float edm[EDML_PAIRS], distance[EDML_PAIRS];

/* As the lift runs a network: on its work memory, in place. */
static void predict(float *out, const float *in, const edml_model *model)
{
    memcpy(work.of.network.io.values, in, model->inputs * sizeof *in);
    edml__run_network(model, &work);
    memcpy(out, work.of.network.io.values, (size_t)edml__output_values(model) * sizeof *out);
}

static void predict_q(int32_t *out, const int32_t *in, const edml_model *model)
{
    memcpy(work_q24.of.network.io.values, in, model->inputs * sizeof *in);
    edml__run_network_q(model, &work_q24);
    memcpy(out, work_q24.of.network.io.values, (size_t)edml__output_values(model) * sizeof *out);
}

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
        predict(distance, edm, &edml_fconn_f32);
        TEST_ASSERT_TRUE(all_finite(distance, EDML_PAIRS));
        for (int n = 0; n < EDML_PAIRS; n++) TEST_ASSERT_TRUE(distance[n] >= 0);
    }
}

static void what_work_memory_held_does_not_matter(void)
{
    static const edml_model *const models[] = {&edml_fconn_f32, &edml_fconn_w8, &edml_direct_f32,
                                               &edml_direct_w16, &edml_distances_f32};
    float out[2 * WIDE], other[2 * WIDE], in[2 * WIDE];
    rng r = rng_seed(1);
    for (int k = 0; k < 2 * WIDE; k++) in[k] = uniform(&r, 0, 3);
    for (unsigned n = 0; n < sizeof models / sizeof *models; n++) {
        memset(&work, 0, sizeof work);
        predict(out, in, models[n]);
        memset(&work, 0xFF, sizeof work); /* NaN */
        predict(other, in, models[n]);
        TEST_ASSERT_EQUAL_MEMORY(out, other, (size_t)edml__output_values(models[n]) * sizeof *out);
    }
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
    predict(distance, edm, &model);
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
    predict(distance, edm, &model);
    for (int n = 0; n < EDML_PAIRS; n++) TEST_ASSERT_TRUE(distance[n] == (n == 3 ? (float)sum : 0.0F));
}

static void negative_sums_become_zero(void)
{
    for (int n = 0; n < EDML_PAIRS; n++) edm[n] = 40;
    const edml_model model = diagonal_model(1, -1, 1);
    predict(distance, edm, &model);
    for (int n = 0; n < EDML_PAIRS; n++) TEST_ASSERT_TRUE(distance[n] == (n < 40 ? (float)(40 - n) : 0.0F));
}

static void layers_follow_one_another(void)
{
    for (int n = 0; n < EDML_PAIRS; n++) edm[n] = (float)n;
    const edml_model model = diagonal_model(2, 1, 2);
    predict(distance, edm, &model);
    for (int n = 0; n < EDML_PAIRS; n++) TEST_ASSERT_TRUE(distance[n] == (float)(4 * n + 3 * n));
}

/* ---- Integers, against model.h's definition written plainly -------------------------------- */

static int32_t in_q24[WIDE], out_q24[2 * WIDE], wanted_q24[2 * WIDE];

static int is_equivariant(const edml_model *model)
{
    return model->predict_q == edml__equivariant_w16 || model->predict_q == edml__equivariant_w8;
}

static int is_w16(const edml_model *model)
{
    return model->predict_q == edml__fconn_w16 || model->predict_q == edml__equivariant_w16;
}

static int full_groups(int rows) { return (rows + EDML_ROWS - 1) / EDML_ROWS * EDML_ROWS; }

static int filled(int inputs) { return (inputs + EDML_CHUNK - 1) / EDML_CHUNK * EDML_CHUNK; }

/* Where a weight of 16 bits is. */
static int place_of(int row, int input, int inputs) { return edml__place(row, input, inputs, 2); }

/* Layer n of a quantised model; one of 8 bits gets weights of 16 from the caller. */
static edml_dense_w16 wide_layer(const edml_model *model, int n, int16_t wide[WIDE * WIDE])
{
    if (is_w16(model)) return ((const edml_dense_w16 *)model->layers)[n];
    const edml_dense_w8 *narrow = &((const edml_dense_w8 *)model->layers)[n];
    for (int row = 0; row < full_groups(narrow->outputs); row++)
        for (int k = 0; k < narrow->inputs; k++)
            wide[place_of(row, k, narrow->inputs)] = narrow->weight[edml__place(row, k, narrow->inputs, 1)];
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
    return layer->weight[place_of(row, input, layer->inputs)];
}

static int64_t activated(int64_t sum, const edml_dense_w16 *layer, int row)
{
    const int64_t half = (int64_t)1 << (layer->shift - 1);
    TEST_ASSERT_TRUE(INT32_MIN <= sum && sum <= INT32_MAX);
    return scaled_down(sum * layer->multiplier[row] + half, layer->shift, layer->clamp);
}

static int16_t wide_weights[WIDE * WIDE];

static void expect_fconn(const int32_t in[EDML_PAIRS], const edml_model *model)
{
    int64_t x[WIDE] = {0}, y[WIDE] = {0};
    for (int k = 0; k < EDML_PAIRS; k++) x[k] = scaled_down((int64_t)in[k] + 2048, 12, 32767);
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
    for (int k = 0; k < EDML_PAIRS; k++) wanted_q24[k] = (int32_t)x[k] * 256; /* from Q16 */
}

/* Without a ReLU: the same on either side of zero. */
static int64_t signed_one(int64_t sum, const edml_dense_w16 *layer, int row)
{
    return 256 * (sum < 0 ? -activated(-sum, layer, row) : activated(sum, layer, row));
}

/* Units and mirror units, by the definition: each reads what is even, and what is odd with either sign. */
static void expect_equivariant(const int32_t *in, const edml_model *model)
{
    int64_t even[WIDE] = {0}, odd[WIDE] = {0}, unit[2][WIDE];
    for (int k = 0; k < model->inputs; k++) { /* to Q12, halves up */
        const int64_t q12 = ((int64_t)in[k] + 2048) >> 12;
        *(k < model->even_inputs ? &even[k] : &odd[k - model->even_inputs]) = q12 < 32767 ? q12 : 32767;
    }
    int evens = filled(model->even_inputs), odds = filled(model->inputs - model->even_inputs);
    for (int n = 0; n < model->layer_count; n++) {
        const edml_dense_w16 layer = wide_layer(model, n, wide_weights);
        const int last = n == model->layer_count - 1, count = full_groups(layer.outputs);
        TEST_ASSERT_EQUAL_INT(layer.inputs, evens + odds);
        for (int row = 0; row < count; row++) {
            int64_t e = layer.bias[row], o = 0;
            for (int i = 0; i < evens; i++) e += weight_of(&layer, row, i) * even[i];
            for (int i = 0; i < odds; i++) o += weight_of(&layer, row, evens + i) * odd[i];
            TEST_ASSERT_TRUE(INT32_MIN <= e && e <= INT32_MAX);
            TEST_ASSERT_TRUE(INT32_MIN <= o && o <= INT32_MAX);
            unit[0][row] = last ? signed_one(e + o, &layer, row) : activated(e + o, &layer, row);
            unit[1][row] = last ? signed_one(e - o, &layer, row) : activated(e - o, &layer, row);
        }
        for (int k = 0; k < count; k++) {
            even[k] = unit[0][k] + unit[1][k];
            odd[k] = unit[0][k] - unit[1][k];
            wanted_q24[k] = (int32_t)unit[0][k];
            wanted_q24[count + k] = (int32_t)unit[1][k];
        }
        evens = odds = count;
    }
}

/* Inputs of all sizes: first what is likely, then anything, then the extremes.  EDMs go as far as a Q24 does,
 * the inputs of the other networks to +-8. */
enum { INPUTS = 40 };
static void fill_inputs(int n, const edml_model *model)
{
    rng r = rng_seed((uint32_t)n);
    const int equivariant = is_equivariant(model);
    const int32_t most = equivariant ? 8 * ONE : n == INPUTS - 1 ? INT32_MAX : HIGHEST;
    const int32_t least = equivariant ? -most : 0;
    const float likely = n < 20 ? 3 * (float)ONE : (float)most;
    for (int k = 0; k < model->inputs; k++) {
        in_q24[k] = (int32_t)uniform(&r, equivariant ? -likely : 0, likely);
        if (n == INPUTS - 4) in_q24[k] = least;
        if (n == INPUTS - 3 || n == INPUTS - 1) in_q24[k] = most;
        if (n == INPUTS - 2) in_q24[k] = k % 2 == 0 ? most : least;
    }
}

/* The model does as defined: between arrays, and in place. */
static void check_against_definition(const edml_model *model)
{
    const size_t size = (size_t)edml__output_values(model) * sizeof *out_q24;
    for (int n = 0; n < INPUTS; n++) {
        fill_inputs(n, model);
        if (is_equivariant(model))
            expect_equivariant(in_q24, model);
        else
            expect_fconn(in_q24, model);
        memset(&work_q24, n, sizeof work_q24);
        model->predict_q(out_q24, in_q24, model, &work_q24.of.network.units);
        TEST_ASSERT_EQUAL_MEMORY(wanted_q24, out_q24, size);
        predict_q(out_q24, in_q24, model);
        TEST_ASSERT_EQUAL_MEMORY(wanted_q24, out_q24, size);
    }
}

static void quantised_models_are_as_defined(void)
{
    static const edml_model *const models[] = {&edml_fconn_w16,    &edml_fconn_w8,   &edml_distances_w16,
                                               &edml_distances_w8, &edml_direct_w16, &edml_direct_w8};
    for (unsigned n = 0; n < sizeof models / sizeof *models; n++) check_against_definition(models[n]);
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
    const edml_model *like;          /* what it reads */
    uint16_t units, inputs, outputs; /* the first layer's; the second's */
    int32_t clamp;
} kind;

static const kind fconn_w16 = {
    edml__fconn_w16, edml__fconn_checksum_w16, 1, &edml_fconn_w16, 100, 100, EDML_PAIRS, 32767};
static const kind fconn_w8 = {
    edml__fconn_w8, edml__fconn_checksum_w8, 0, &edml_fconn_w16, 100, 100, EDML_PAIRS, 32767};
static const kind direct_w16 = {
    edml__equivariant_w16, edml__equivariant_checksum_w16, 1, &edml_direct_w16, 48, 96, 32, 16383};
static const kind direct_w8 = {
    edml__equivariant_w8, edml__equivariant_checksum_w8, 0, &edml_direct_w16, 48, 96, 32, 16383};
static const kind distances_w16 = {
    edml__equivariant_w16, edml__equivariant_checksum_w16, 1, &edml_distances_w16, 48, 96, 81, 16383};
static const kind distances_w8 = {
    edml__equivariant_w8, edml__equivariant_checksum_w8, 0, &edml_distances_w16, 48, 96, 81, 16383};
static const kind *const kinds[] = {&fconn_w16, &fconn_w8,      &direct_w16,
                                    &direct_w8, &distances_w16, &distances_w8};

static edml_model random_model(uint32_t seed, const kind *of)
{
    rng r = rng_seed(seed);
    for (int n = 0; n < 2; n++) {
        const int even = of->like->even_inputs, odd = of->like->inputs - even;
        const uint16_t inputs = (uint16_t)(n == 0 ? filled(even) + filled(odd) : filled(of->inputs));
        const uint16_t outputs = n == 0 ? of->units : of->outputs;
        const uint8_t shift = 32;
        const int32_t limit = n == 0 ? of->clamp : 3 << 16;
        for (int k = 0; k < WIDE * WIDE; k++) {
            weight_w16[n][k] = (int16_t)((int)(rng_bits(&r) % 511) - 255);
            weight_w8[n][k] = (int8_t)((int)(rng_bits(&r) % 255) - 127);
        }
        for (int k = 0; k < WIDE; k++) {
            bias_q24[n][k] = (int32_t)uniform(&r, -(1 << 26), 1 << 26);
            multiplier_q24[n][k] = k == 0 ? 1 : k == 1 ? INT32_MAX : (int32_t)(rng_bits(&r) >> 10 | 1);
        }
        const edml_dense_w16 w16 = {inputs, outputs, weight_w16[n], bias_q24[n], multiplier_q24[n],
                                    shift,  limit};
        const edml_dense_w8 w8 = {inputs, outputs, weight_w8[n], bias_q24[n], multiplier_q24[n],
                                  shift,  limit};
        layers_w16[n] = w16;
        layers_w8[n] = w8;
    }
    edml_model model = *of->like;
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

/* With what is odd negated, rows and mirror rows change places, to the last bit. */
static void mirrored_inputs_exchange_rows_and_mirror_rows(void)
{
    static const edml_model *const models[] = {&edml_direct_f32,    &edml_direct_w16,
                                               &edml_direct_w8,     &edml_distances_f32,
                                               &edml_distances_w16, &edml_distances_w8};
    float in[WIDE], mirrored[WIDE], out[2 * WIDE], other[2 * WIDE];
    for (uint32_t seed = 0; seed < 20; seed++) {
        rng r = rng_seed(seed);
        for (unsigned n = 0; n < sizeof models / sizeof *models; n++) {
            const int values = edml__output_values(models[n]), rows = values / 2;
            for (int k = 0; k < models[n]->inputs; k++) {
                in[k] = floorf(uniform(&r, -2 * 4096, 2 * 4096)) / 4096; /* which integers hold exactly */
                mirrored[k] = k < models[n]->even_inputs ? in[k] : -in[k];
            }
            predict(out, in, models[n]);
            predict(other, mirrored, models[n]);
            int differ = 0;
            for (int k = 0; k < values; k++) {
                TEST_ASSERT_TRUE(out[k] == other[(k + rows) % values]);
                differ += out[k] != other[k];
            }
            TEST_ASSERT_TRUE(differ > values / 2);
        }
    }
}

/* ---- Equivariant networks in float, against the definition in double ------------------------------ */

static float weight_f32[2][WIDE * WIDE], bias_f32[2][WIDE];
static edml_dense_f32 layers_f32[2];
static double wanted[2 * WIDE];

static void expect_equivariant_f32(const float *in, const edml_model *model)
{
    double even[WIDE], odd[WIDE];
    int evens = model->even_inputs, odds = model->inputs - model->even_inputs;
    for (int k = 0; k < model->inputs; k++) *(k < evens ? &even[k] : &odd[k - evens]) = (double)in[k];
    for (int n = 0; n < model->layer_count; n++) {
        const edml_dense_f32 *layer = &((const edml_dense_f32 *)model->layers)[n];
        const int last = n == model->layer_count - 1, count = full_groups(layer->outputs);
        for (int row = 0; row < count; row++) {
            const float *w = layer->weight + row / 8 * 8 * layer->inputs + row % 8;
            double e = (double)layer->bias[row], o = 0;
            for (int i = 0; i < evens; i++) e += (double)w[8 * i] * even[i];
            for (int i = 0; i < odds; i++) o += (double)w[8 * (evens + i)] * odd[i];
            wanted[row] = last ? e + o : fmax(e + o, 0);
            wanted[count + row] = last ? e - o : fmax(e - o, 0);
        }
        for (int k = 0; k < count; k++) {
            even[k] = wanted[k] + wanted[count + k];
            odd[k] = wanted[k] - wanted[count + k];
        }
        evens = odds = count;
    }
}

/* Two layers whose outputs are about 1. */
static edml_model random_model_f32(rng *r, const edml_model *like)
{
    for (int n = 0; n < 2; n++) {
        const uint16_t inputs = n == 0 ? like->inputs : 96, outputs = n == 0 ? 48 : like->outputs;
        for (int k = 0; k < WIDE * WIDE; k++) weight_f32[n][k] = 0.1F * gauss(r);
        for (int k = 0; k < WIDE; k++) bias_f32[n][k] = gauss(r);
        const edml_dense_f32 layer = {inputs, outputs, weight_f32[n], bias_f32[n]};
        layers_f32[n] = layer;
    }
    edml_model model = *like;
    model.layers = layers_f32;
    model.layer_count = 2;
    return model;
}

static void check_f32_against_definition(rng *r, const edml_model *model)
{
    float in[WIDE], out[2 * WIDE];
    for (int k = 0; k < model->inputs; k++) in[k] = uniform(r, -3, 3);
    expect_equivariant_f32(in, model);
    predict(out, in, model);
    for (int k = 0; k < edml__output_values(model); k++)
        TEST_ASSERT_FLOAT_WITHIN(NET_F32_TOLERANCE, (float)wanted[k], out[k]);
}

static void float_equivariant_networks_are_as_defined(void)
{
    rng r = rng_seed(9);
    for (int n = 0; n < 20; n++) {
        check_f32_against_definition(&r, &edml_direct_f32);
        check_f32_against_definition(&r, &edml_distances_f32);
        const edml_model model = random_model_f32(&r, n % 2 ? &edml_direct_f32 : &edml_distances_f32);
        check_f32_against_definition(&r, &model);
    }
}

/* ---- Rounding and limits of integers ---------------------------------------------------------------- */

/* One layer y_n = (sum_n multiplier + half) >> shift, sum_n = x_n + offset.  As it is the last one, y is in
 * Q16 and limited to `clamp`. */
static edml_model identity_w16(int32_t offset, int32_t multiplier, uint8_t shift, int32_t clamp)
{
    memset(weight_w16[0], 0, sizeof weight_w16[0]);
    for (int n = 0; n < EDML_PAIRS; n++) {
        weight_w16[0][place_of(n, n, filled(EDML_PAIRS))] = 1;
        bias_q24[0][n] = offset;
        multiplier_q24[0][n] = multiplier;
    }
    const edml_dense_w16 layer = {(uint16_t)filled(EDML_PAIRS),
                                  EDML_PAIRS,
                                  weight_w16[0],
                                  bias_q24[0],
                                  multiplier_q24[0],
                                  shift,
                                  clamp};
    layers_w16[0] = layer;
    edml_model model = edml_fconn_w16;
    model.predict_q = edml__fconn_w16;
    model.layers = layers_w16;
    model.layer_count = 1;
    return model;
}

static int32_t first_distance(const edml_model *model, int32_t edm_value)
{
    for (int k = 0; k < EDML_PAIRS; k++) in_q24[k] = edm_value;
    predict_q(out_q24, in_q24, model);
    for (int k = 1; k < EDML_PAIRS; k++) TEST_ASSERT_EQUAL_INT32(out_q24[0], out_q24[k]);
    return out_q24[0];
}

static void integers_are_rounded_to_nearest(void)
{
    const edml_model input = identity_w16(0, 1 << 16, 16, 3 << 16); /* y = x */
    TEST_ASSERT_EQUAL_INT32(0, first_distance(&input, 2047));
    TEST_ASSERT_EQUAL_INT32(256, first_distance(&input, 2048));
    TEST_ASSERT_EQUAL_INT32(256, first_distance(&input, 4096 + 2047));
    const edml_model output = identity_w16(0, 3 << 13, 16, 3 << 16); /* y = 3/8 x */
    TEST_ASSERT_EQUAL_INT32(0, first_distance(&output, 1 << 12));
    TEST_ASSERT_EQUAL_INT32(256, first_distance(&output, 2 << 12));
    TEST_ASSERT_EQUAL_INT32(2 * 256, first_distance(&output, 4 << 12)); /* a half goes up */
}

static void integers_are_limited(void)
{
    const edml_model wide = identity_w16(0, 1 << 16, 16, INT32_MAX);
    TEST_ASSERT_EQUAL_INT32(256 * EDML_ACTIVATION, first_distance(&wide, HIGHEST));
    const edml_model far = identity_w16(INT32_MAX - EDML_ACTIVATION, INT32_MAX, 32, 3 << 16);
    TEST_ASSERT_EQUAL_INT32(3 << 24, first_distance(&far, HIGHEST));
    const edml_model below = identity_w16(INT32_MIN, INT32_MAX, 2, 3 << 16);
    TEST_ASSERT_EQUAL_INT32(0, first_distance(&below, HIGHEST));
    const edml_model tiny = identity_w16(INT32_MAX - EDML_ACTIVATION, 2, 32, 3 << 16);
    TEST_ASSERT_EQUAL_INT32(256, first_distance(&tiny, HIGHEST));
    const edml_model nothing = identity_w16(INT32_MAX - EDML_ACTIVATION, 1, 32, 3 << 16);
    TEST_ASSERT_EQUAL_INT32(0, first_distance(&nothing, HIGHEST)); /* a half but for one in 2^32 */
}

/* An equivariant layer whose first row is an even input plus an odd one. */
static edml_model sum_w16(int32_t offset, int32_t multiplier, uint8_t shift)
{
    memset(weight_w16[0], 0, sizeof weight_w16[0]);
    const int even = filled(edml_direct_w16.even_inputs);
    const int inputs = even + filled(edml_direct_w16.inputs - edml_direct_w16.even_inputs);
    weight_w16[0][place_of(0, 0, inputs)] = weight_w16[0][place_of(0, even, inputs)] = 1;
    for (int k = 0; k < 32; k++) {
        bias_q24[0][k] = offset;
        multiplier_q24[0][k] = multiplier;
    }
    const edml_dense_w16 layer = {(uint16_t)inputs,  32,    weight_w16[0], bias_q24[0],
                                  multiplier_q24[0], shift, 3 << 16};
    layers_w16[0] = layer;
    edml_model model = edml_direct_w16;
    model.predict_q = edml__equivariant_w16;
    model.layers = layers_w16;
    model.layer_count = 1;
    return model;
}

/* first, second: Q16 */
static void check_sum(const edml_model *model, int32_t even, int32_t odd, int32_t first, int32_t second)
{
    memset(in_q24, 0, sizeof in_q24);
    in_q24[0] = even;
    in_q24[model->even_inputs] = odd;
    predict_q(out_q24, in_q24, model);
    TEST_ASSERT_EQUAL_INT32(256 * first, out_q24[0]);
    TEST_ASSERT_EQUAL_INT32(256 * second, out_q24[32]);
}

static void signed_integers_are_rounded_and_limited_on_either_side(void)
{
    const edml_model exact = sum_w16(0, 1 << 17, 17); /* y = x */
    check_sum(&exact, 5 << 12, 3 << 12, 8, 2);
    check_sum(&exact, -(5 << 12), 3 << 12, -2, -8);
    check_sum(&exact, 2047, -2048, 0, 0); /* inputs to Q12: halves up */
    check_sum(&exact, 2048, -2049, 0, 2);
    check_sum(&exact, 8 * ONE, 0, 32767, 32767); /* inputs end at 32767 ... */
    check_sum(&exact, -8 * ONE, 0, -32768, -32768);
    check_sum(&exact, -9 * ONE, 0, -32768, -32768);
    const edml_model eighth = sum_w16(0, 3 << 14, 17); /* y = 3/8 x */
    check_sum(&eighth, 4 << 12, 0, 2, 2);              /* 1.5: halves up */
    check_sum(&eighth, -(4 << 12), 0, -1, -1);
    check_sum(&eighth, 1 << 12, 0, 0, 0);
    check_sum(&eighth, -(1 << 12), 0, 0, 0);
    const edml_model far = sum_w16(0, INT32_MAX, 20); /* ... and outputs at 3 m */
    check_sum(&far, 7 * ONE, 0, 3 << 16, 3 << 16);
    check_sum(&far, -7 * ONE, 0, -(3 << 16), -(3 << 16));
    check_sum(&far, 0, 7 * ONE, 3 << 16, -(3 << 16));
    const edml_model high = sum_w16(INT32_MAX - 65535, 2, 32);
    check_sum(&high, 7 * ONE, 0, 1, 1);
    const edml_model low = sum_w16(-INT32_MAX + 65536, 2, 32);
    check_sum(&low, -7 * ONE, 0, -1, -1);
}

/* ---- Shipped models ------------------------------------------------------------------------------------ */

/* What is said of people, in RMS against the float network. */
static float rms_from_float(const edml_model *model, const edml_model *exact)
{
    static edml_prediction said, wanted_said;
    rng r = rng_seed(5);
    double sum = 0;
    int count = 0;
    memset(&said, 0, sizeof said);
    memset(&wanted_said, 0, sizeof wanted_said);
    for (int n = 0; n < 200; n++) {
        edml_point x[EDML_JOINTS];
        edml_keypoint in[EDML_JOINTS];
        edml_image image;
        random_human(&r, x);
        photograph(in, x);
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_body_frame(&image, in, EDML_JOINTS, model->imputation));
        edml_predict(&wanted_said, &image, NULL, exact, &work, sizeof work);
        edml_predict(&said, &image, NULL, model, &work, sizeof work);
        const int points = (model->gives & EDML_GIVES_POINTS) != 0;
        const float *const a = points ? &said.x[0].x : said.distance;
        const float *const b = points ? &wanted_said.x[0].x : wanted_said.distance;
        for (int k = 0; k < (points ? 3 * EDML_JOINTS : EDML_PAIRS); k++, count++)
            sum += ((double)a[k] - (double)b[k]) * ((double)a[k] - (double)b[k]);
    }
    const float rms = (float)sqrt(sum / count);
    printf("%s: %.3f mm from float\n", edml_model_name(model), 1e3 * (double)rms);
    return rms;
}

static void quantised_models_are_near_the_float_one(void)
{
    TEST_ASSERT_ERROR_UP_TO(NET_W16_TOLERANCE, rms_from_float(&edml_fconn_w16, &edml_fconn_f32));
    TEST_ASSERT_ERROR_UP_TO(NET_W8_TOLERANCE, rms_from_float(&edml_fconn_w8, &edml_fconn_f32));
    TEST_ASSERT_ERROR_UP_TO(NET_W16_TOLERANCE, rms_from_float(&edml_direct_w16, &edml_direct_f32));
    TEST_ASSERT_ERROR_UP_TO(NET_W8_TOLERANCE, rms_from_float(&edml_direct_w8, &edml_direct_f32));
    TEST_ASSERT_ERROR_UP_TO(NET_W16_TOLERANCE, rms_from_float(&edml_distances_w16, &edml_distances_f32));
    TEST_ASSERT_ERROR_UP_TO(NET_W8_TOLERANCE, rms_from_float(&edml_distances_w8, &edml_distances_f32));
}

/* ---- Models ------------------------------------------------------------------------------------ */

static void the_models_have_their_names(void)
{
    TEST_ASSERT_EQUAL_STRING("fconn_f32", edml_model_name(&edml_fconn_f32));
    TEST_ASSERT_EQUAL_STRING("fconn_w16", edml_model_name(&edml_fconn_w16));
    TEST_ASSERT_EQUAL_STRING("fconn_w8", edml_model_name(&edml_fconn_w8));
    TEST_ASSERT_EQUAL_STRING("direct_f32", edml_model_name(&edml_direct_f32));
    TEST_ASSERT_EQUAL_STRING("direct_w16", edml_model_name(&edml_direct_w16));
    TEST_ASSERT_EQUAL_STRING("direct_w8", edml_model_name(&edml_direct_w8));
    TEST_ASSERT_EQUAL_STRING("distances_f32", edml_model_name(&edml_distances_f32));
    TEST_ASSERT_EQUAL_STRING("distances_w16", edml_model_name(&edml_distances_w16));
    TEST_ASSERT_EQUAL_STRING("distances_w8", edml_model_name(&edml_distances_w8));
}

static void the_models_are_sound(void)
{
    static const edml_model *const models[] = {
        &edml_fconn_f32, &edml_fconn_w16,     &edml_fconn_w8,      &edml_direct_f32,  &edml_direct_w16,
        &edml_direct_w8, &edml_distances_f32, &edml_distances_w16, &edml_distances_w8};
    for (unsigned n = 0; n < sizeof models / sizeof *models; n++)
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_model_check(models[n]));
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
    enum { LAST = (EDML_PAIRS + EDML_ROWS - 1) / EDML_ROWS * EDML_ROWS - 1, UNITS = 100 };
    const edml_model w16 = random_model(7, &fconn_w16);
    check_flipped_byte(&w16, &weight_w16[0][0]);
    check_flipped_byte(&w16, (uint8_t *)&weight_w16[1][(LAST + 1) * UNITS] - 1);
    check_flipped_byte(&w16, &bias_q24[0][5]);
    check_flipped_byte(&w16, (uint8_t *)&multiplier_q24[1][LAST + 1] - 1);
    const edml_model w8 = random_model(7, &fconn_w8);
    check_flipped_byte(&w8, &weight_w8[0][0]);
    check_flipped_byte(&w8, &weight_w8[1][(LAST + 1) * UNITS - 1]);
    check_flipped_byte(&w8, &bias_q24[1][LAST]);
    check_flipped_byte(&w8, &multiplier_q24[0][0]);
    const edml_model equivariant = random_model(7, &distances_w16); /* with its filled-up group */
    check_flipped_byte(&equivariant, &weight_w16[0][0]);
    check_flipped_byte(&equivariant, (uint8_t *)&weight_w16[1][88 * 96] - 1);
    check_flipped_byte(&equivariant, &bias_q24[1][87]);
    check_flipped_byte(&equivariant, &multiplier_q24[0][47]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(distances_are_finite_and_not_negative);
    RUN_TEST(what_work_memory_held_does_not_matter);
    RUN_TEST(a_layer_is_weight_times_input_plus_bias);
    RUN_TEST(a_layer_adds_up_all_inputs);
    RUN_TEST(negative_sums_become_zero);
    RUN_TEST(layers_follow_one_another);
    RUN_TEST(quantised_models_are_as_defined);
    RUN_TEST(random_layers_are_as_defined);
    RUN_TEST(mirrored_inputs_exchange_rows_and_mirror_rows);
    RUN_TEST(float_equivariant_networks_are_as_defined);
    RUN_TEST(integers_are_rounded_to_nearest);
    RUN_TEST(integers_are_limited);
    RUN_TEST(signed_integers_are_rounded_and_limited_on_either_side);
    RUN_TEST(quantised_models_are_near_the_float_one);
    RUN_TEST(the_models_have_their_names);
    RUN_TEST(the_models_are_sound);
    RUN_TEST(a_wrong_checksum_is_noticed);
    RUN_TEST(one_flipped_bit_in_weight_or_bias_is_noticed);
    RUN_TEST(one_flipped_bit_in_integers_is_noticed);
    return UNITY_END();
}
