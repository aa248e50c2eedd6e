/* lift/predict.h and inputs.h: what networks read of an image, and what is made of what they give.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>

#include "native.h"
#include "network/model.h" /* to put a network of our own into a model */

enum { FIRST_PAIRS = 49, MIRRORED_PAIRS = 42, FIRST_JOINTS = 8, MIDDLE = 2, MOST = 196 };

static edml_work work;
static edml_image image;
static edml_prediction said, again;
static point_f32 up;

/* ---- Images ---------------------------------------------------------------------------------------------- */

static float image_u[EDML_JOINTS], image_v[EDML_JOINTS]; /* in floats */
static float down_u, down_v;

static void use_image(void)
{
    const uint16_t seen = image.seen;
    memset(&image, 0, sizeof image);
    for (int j = 0; j < EDML_JOINTS; j++) {
        image.at[j].u = to_real(image_u[j]);
        image.at[j].v = to_real(image_v[j]);
    }
    image.down.u = to_real(down_u);
    image.down.v = to_real(down_v);
    image.seen = seen;
}

/* A person in the body's frame, or anything; 2^-12 is the step of integer networks. */
static void draw(rng *r, int person)
{
    point_f32 x[EDML_JOINTS];
    const float angle = uniform(r, -3.14F, 3.14F);
    random_human(r, x);
    if (!person) random_points(r, x, 3.9F * 0.85F);
    for (int j = 0; j < EDML_JOINTS; j++) {
        image_u[j] = floorf(4096 * x[j].x / 0.85F) / 4096;
        image_v[j] = floorf(4096 * x[j].y / 0.85F) / 4096;
    }
    down_u = sinf(angle);
    down_v = cosf(angle);
    image.seen = ALL_SEEN;
    for (int n = 0; n < 3; n++)
        if (rng_bits(r) % 2) image.seen = (uint16_t)(image.seen & ~(1U << rng_bits(r) % EDML_JOINTS));
    use_image();
    double square = 0;
    up.x = gauss(r);
    up.y = gauss(r);
    up.z = gauss(r);
    square = (double)up.x * (double)up.x + (double)up.y * (double)up.y + (double)up.z * (double)up.z;
    up.x /= (float)sqrt(square);
    up.y /= (float)sqrt(square);
    up.z /= (float)sqrt(square);
}

static void run_with(edml_prediction *out, const edml_model *model, const point_f32 *upwards)
{
    point native[EDML_JOINTS];
    memset(out, 0, sizeof *out);
    if (upwards != NULL) {
        native[0].x = to_real(upwards->x);
        native[0].y = to_real(upwards->y);
        native[0].z = to_real(upwards->z);
    }
    TEST_ASSERT_EQUAL_INT(
        EDML_OK, edml_predict(out, &image, upwards != NULL ? native : NULL, model, &work, sizeof work));
}

/* ---- What networks read, by another text ------------------------------------------------------------------ */

static float read[MOST]; /* what a network was given */
static int read_count;

static void spy(real *out, const real *in, const edml_model *model, void *scratch)
{
    (void)scratch;
    read_count = model->inputs;
    from_reals(read, in, read_count);
    memset(out, 0, (size_t)edml__output_values(model) * sizeof *out);
}

static edml_model spied_on(const edml_model *model)
{
    edml_model other = *model;
    other.PREDICT = spy;
    return other;
}

static const int first_joint[FIRST_JOINTS] = {
    EDML_HEAD,    EDML_NECK_BASE, EDML_R_SHOULDER, EDML_R_ELBOW,
    EDML_R_WRIST, EDML_R_HIP,     EDML_R_KNEE,     EDML_R_ANKLE,
};

/* The pair with left for right. */
static int mirror_pair_of(int i, int j)
{
    const int a = edml_mirror_joint[i], b = edml_mirror_joint[j];
    return a < b ? EDML_PAIR(a, b) : EDML_PAIR(b, a);
}

/* Pairs in their order, the first of two mirror pairs alone; then those that mirror themselves. */
static void first_pairs(int pair[FIRST_PAIRS][2])
{
    int count = 0;
    for (int own = 0; own < 2; own++)
        for (int i = 0; i < EDML_JOINTS; i++)
            for (int j = i + 1; j < EDML_JOINTS; j++) {
                const int mirror = mirror_pair_of(i, j);
                if (own ? EDML_PAIR(i, j) != mirror : EDML_PAIR(i, j) >= mirror) continue;
                pair[count][0] = EDML_PAIR(i, j);
                pair[count++][1] = mirror;
            }
    TEST_ASSERT_EQUAL_INT(FIRST_PAIRS, count);
}

static double softened(int pair)
{
    int n = 0;
    for (int i = 0; i < EDML_JOINTS; i++)
        for (int j = i + 1; j < EDML_JOINTS; j++, n++)
            if (n == pair) {
                const double u = (double)image_u[i] - (double)image_u[j];
                const double v = (double)image_v[i] - (double)image_v[j];
                const double d = fmin(hypot(u, v), 7.99);
                return d * d / (d + 2458 / 4096.0);
            }
    return NAN;
}

/* even, then odd; returns how many there are. */
static int expect_inputs(double wanted[MOST], int distances, const point_f32 *upwards)
{
    double even[MOST], odd[MOST];
    int evens = 0, odds = 0, pair[FIRST_PAIRS][2];
    first_pairs(pair);
    for (int k = 0; k < FIRST_PAIRS && distances; k++) {
        even[evens++] = softened(pair[k][0]) + softened(pair[k][1]) - 7;
        if (k < MIRRORED_PAIRS) odd[odds++] = softened(pair[k][0]) - softened(pair[k][1]);
    }
    for (int kind = 0; kind < 3; kind++) { /* across, along, missing */
        for (int k = 0; k < FIRST_JOINTS; k++) {
            const int r = first_joint[k], l = edml_mirror_joint[r];
            const double missing_r = image.seen >> r & 1 ? 0 : 0.7,
                         missing_l = image.seen >> l & 1 ? 0 : 0.7;
            const double a = kind == 0 ? (double)image_u[r] : kind == 1 ? (double)image_v[r] : missing_r;
            const double b = kind == 0 ? (double)image_u[l] : kind == 1 ? (double)image_v[l] : missing_l;
            *(kind == 0 ? &odd[odds++] : &even[evens++]) = a + b;
            if (k >= MIDDLE) *(kind == 0 ? &even[evens++] : &odd[odds++]) = a - b;
        }
    }
    const double x = upwards != NULL ? (double)upwards->x : 0, y = upwards != NULL ? (double)upwards->y : 0;
    even[evens++] = upwards != NULL ? 2 * ((double)down_u * x + (double)down_v * y + 1) : 0;
    even[evens++] = upwards != NULL ? 4 * (double)upwards->z : 0;
    even[evens++] = upwards != NULL;
    odd[odds++] = 2 * ((double)down_v * x - (double)down_u * y);
    memcpy(wanted, even, (size_t)evens * sizeof *wanted);
    memcpy(wanted + evens, odd, (size_t)odds * sizeof *wanted);
    return evens + odds;
}

static void check_inputs(const edml_model *model, const point_f32 *upwards)
{
    double wanted[MOST];
    const edml_model spied = spied_on(model);
    run_with(&said, &spied, upwards);
    const int count = expect_inputs(wanted, (model->reads & EDML_READS_DISTANCES) != 0, upwards);
    TEST_ASSERT_EQUAL_INT(count, read_count);
    for (int k = 0; k < count; k++) {
        TEST_ASSERT_FLOAT_WITHIN(INPUT_TOLERANCE, (float)wanted[k], read[k]);
        TEST_ASSERT_TRUE(read[k] >= -8 && read[k] <= 8);
    }
}

static void inputs_are_as_defined(void)
{
    rng r = rng_seed(1);
    for (int n = 0; n < 200; n++) {
        draw(&r, n % 2);
        check_inputs(&DIRECT, n % 3 ? &up : NULL);
        check_inputs(&DISTANCES, n % 3 ? &up : NULL);
    }
}

/* Joints in the corners of the range, alike or opposite; up along an axis. */
static void no_input_is_beyond_8(void)
{
    rng r = rng_seed(2);
    for (int n = 0; n < 200; n++) {
        draw(&r, 0);
        for (int j = 0; j < EDML_JOINTS; j++) {
            image_u[j] = rng_bits(&r) % 2 ? 3.9F : -3.9F;
            image_v[j] = rng_bits(&r) % 2 ? 3.9F : -3.9F;
        }
        image.seen = n % 2 ? 0 : ALL_SEEN;
        use_image();
        up.x = n % 3 == 0 ? 1 : 0;
        up.y = n % 3 == 1 ? -1 : 0;
        up.z = n % 3 == 2 ? -1 : 0;
        check_inputs(&DIRECT, &up);
        check_inputs(&DISTANCES, &up);
    }
}

/* A network of distances alone: those of the image, and 0 where joints are missing and not imputed. */
static void fconn_reads_the_edm(void)
{
    rng r = rng_seed(3);
    for (int n = 0; n < 50; n++) {
        edml_model spied = spied_on(&FCONN);
        if (n % 2) spied.imputation = NULL;
        draw(&r, 1);
        run_with(&said, &spied, n % 3 ? &up : NULL);
        TEST_ASSERT_EQUAL_INT(EDML_PAIRS, read_count);
        for (int i = 0; i < EDML_JOINTS; i++) {
            for (int j = i + 1; j < EDML_JOINTS; j++) {
                const int missing = !(image.seen >> i & 1) || !(image.seen >> j & 1);
                const double d = hypot((double)image_u[i] - (double)image_u[j],
                                       (double)image_v[i] - (double)image_v[j]);
                const float wanted = missing && spied.imputation == NULL ? 0 : (float)d;
                TEST_ASSERT_FLOAT_WITHIN(EDM_TOLERANCE, wanted, read[EDML_PAIR(i, j)]);
            }
        }
    }
}

/* ---- What is made of what they give ------------------------------------------------------------------------ */

static float rows[MOST]; /* that a network gives, the mirror rows behind the rows */

static void give(real *out, const real *in, const edml_model *model, void *scratch)
{
    (void)in;
    (void)scratch;
    to_reals(out, rows, edml__output_values(model));
}

static void give_rows(rng *r, const edml_model *model)
{
    edml_model giving = *model;
    giving.PREDICT = give;
    for (int k = 0; k < MOST; k++) rows[k] = uniform(r, -3, 3);
    draw(r, 1);
    run_with(&said, &giving, NULL);
}

/* Of the joint k of first_joint, or the one that mirrors it. */
static float given(int first_row, int k, int mirrored, int count, float sign)
{
    return k < MIDDLE || !mirrored ? rows[first_row + k] : sign * rows[count + first_row + k];
}

/* Points about their mean, from rows of x, y and z. */
static void check_points(int first_row, int count)
{
    for (int axis = 0; axis < 3; axis++) {
        const int row = first_row + 8 * axis;
        const float sign = axis == 0 ? -1 : 1;
        float mean = 0;
        for (int k = 0; k < FIRST_JOINTS; k++) {
            mean += given(row, k, 0, count, sign) / EDML_JOINTS;
            if (k >= MIDDLE) mean += given(row, k, 1, count, sign) / EDML_JOINTS;
        }
        for (int k = 0; k < FIRST_JOINTS; k++) {
            for (int mirrored = 0; mirrored < 2; mirrored++) {
                const int j = mirrored ? edml_mirror_joint[first_joint[k]] : first_joint[k];
                TEST_ASSERT_FLOAT_WITHIN(ROUNDING, given(row, k, mirrored, count, sign) - mean,
                                         from_real((&said.x[j].x)[axis]));
            }
        }
    }
}

static void check_shares(int first_row, int count)
{
    for (int k = 0; k < FIRST_JOINTS; k++) {
        for (int mirrored = 0; mirrored < 2; mirrored++) {
            const int j = mirrored ? edml_mirror_joint[first_joint[k]] : first_joint[k];
            const double gate = (double)given(first_row, k, mirrored, count, 1);
            const double wanted = (1 + gate / (fabs(gate) + 0.125)) / 2;
            TEST_ASSERT_FLOAT_WITHIN(ROUNDING, (float)wanted, from_real(said.share[j]));
        }
    }
}

static void rows_of_direct_become_points_about_their_mean_and_shares(void)
{
    rng r = rng_seed(4);
    for (int n = 0; n < 50; n++) {
        give_rows(&r, &DIRECT);
        check_points(0, 32);
        check_shares(24, 32);
    }
}

static void rows_of_distances_become_distances_points_and_shares(void)
{
    int pair[FIRST_PAIRS][2];
    rng r = rng_seed(5);
    first_pairs(pair);
    for (int n = 0; n < 50; n++) {
        give_rows(&r, &DISTANCES);
        for (int k = 0; k < FIRST_PAIRS; k++) {
            const float first = fmaxf(rows[k], 0),
                        second = k < MIRRORED_PAIRS ? fmaxf(rows[88 + k], 0) : first;
            TEST_ASSERT_FLOAT_WITHIN(ROUNDING, first, from_real(said.distance[pair[k][0]]));
            TEST_ASSERT_FLOAT_WITHIN(ROUNDING, second, from_real(said.distance[pair[k][1]]));
        }
        check_points(49, 88);
        check_shares(73, 88);
    }
}

static void without_gates_all_shares_are_the_models(void)
{
    rng r = rng_seed(6);
    draw(&r, 1);
    run_with(&said, &FCONN, NULL);
    for (int j = 0; j < EDML_JOINTS; j++)
        TEST_ASSERT_TRUE(said.share[j] == PARAM(FCONN.fusion[FUSION_SHARE]));
}

/* ---- With the library's own --------------------------------------------------------------------------------- */

static void look_into_a_mirror(void)
{
    float u[EDML_JOINTS], v[EDML_JOINTS];
    uint16_t seen = 0;
    for (int j = 0; j < EDML_JOINTS; j++) {
        const int m = edml_mirror_joint[j];
        u[j] = -image_u[m];
        v[j] = image_v[m];
        if (image.seen >> m & 1) seen = (uint16_t)(seen | 1U << j);
    }
    memcpy(image_u, u, sizeof u);
    memcpy(image_v, v, sizeof v);
    down_u = -down_u;
    up.x = -up.x;
    image.seen = seen;
    use_image();
}

/* To the last bit in float, but for the mean of the points. */
static void mirrored_people_are_mirrored(void)
{
    rng r = rng_seed(7);
    for (int n = 0; n < 100; n++) {
        for (int way = 0; way < 2; way++) {
            const edml_model *const model = way ? &DIRECT : &DISTANCES;
            draw(&r, 1);
            run_with(&said, model, n % 2 ? &up : NULL);
            look_into_a_mirror();
            run_with(&again, model, n % 2 ? &up : NULL);
            for (int i = 0; i < EDML_JOINTS; i++) {
                const int m = edml_mirror_joint[i];
                TEST_ASSERT_FLOAT_WITHIN(MIRRORED_SHARE, from_real(said.share[i]),
                                         from_real(again.share[m]));
                TEST_ASSERT_FLOAT_WITHIN(MIRRORED_POINTS, from_real(said.x[i].x), -from_real(again.x[m].x));
                TEST_ASSERT_FLOAT_WITHIN(MIRRORED_POINTS, from_real(said.x[i].y), from_real(again.x[m].y));
                TEST_ASSERT_FLOAT_WITHIN(MIRRORED_POINTS, from_real(said.x[i].z), from_real(again.x[m].z));
                for (int j = i + 1; j < EDML_JOINTS; j++)
                    TEST_ASSERT_FLOAT_WITHIN(MIRRORED_METRES, from_real(said.distance[EDML_PAIR(i, j)]),
                                             from_real(again.distance[mirror_pair_of(i, j)]));
            }
        }
    }
}

/* The image is in the body's frame already: a roll turns nothing but `down` and up. */
static void up_is_turned_to_the_bodys_frame(void)
{
    rng r = rng_seed(8);
    for (int n = 0; n < 100; n++) {
        const edml_model *const model = n % 2 ? &DIRECT : &DISTANCES;
        draw(&r, 1);
        run_with(&said, model, &up);
        const float angle = uniform(&r, -3, 3), c = cosf(angle), s = sinf(angle);
        const float u = down_u, x = up.x;
        down_u = c * u - s * down_v;
        down_v = s * u + c * down_v;
        up.x = c * x - s * up.y;
        up.y = s * x + c * up.y;
        use_image();
        run_with(&again, model, &up);
        for (int k = 0; k < EDML_PAIRS; k++)
            TEST_ASSERT_FLOAT_WITHIN(TURNED_METRES, from_real(said.distance[k]),
                                     from_real(again.distance[k]));
        for (int j = 0; j < EDML_JOINTS; j++) {
            TEST_ASSERT_FLOAT_WITHIN(TURNED_METRES, from_real(said.x[j].x), from_real(again.x[j].x));
            TEST_ASSERT_FLOAT_WITHIN(TURNED_METRES, from_real(said.x[j].z), from_real(again.x[j].z));
        }
    }
}

static void without_up_down_does_not_matter_and_up_does(void)
{
    const point_f32 level = {0, -1, 0};
    rng r = rng_seed(9);
    for (int way = 0; way < 2; way++) {
        const edml_model *const model = way ? &DIRECT : &DISTANCES;
        draw(&r, 1);
        run_with(&said, model, NULL);
        down_u = 0;
        down_v = 1;
        use_image();
        run_with(&again, model, NULL);
        TEST_ASSERT_SAME_BYTES(said, again);
        run_with(&again, model, &level);
        TEST_ASSERT_TRUE(memcmp(&said, &again, sizeof said) != 0);
    }
    run_with(&said, &FCONN, NULL);
    run_with(&again, &FCONN, &level);
    TEST_ASSERT_SAME_BYTES(said, again);
}

static void predictions_are_in_range(void)
{
    const edml_model *const models[] = {&DISTANCES, &DIRECT, &FCONN};
    rng r = rng_seed(10);
    for (int n = 0; n < 300; n++) {
        draw(&r, n % 2);
        run_with(&said, models[n % 3], n % 4 ? &up : NULL);
        for (int k = 0; k < EDML_PAIRS; k++) TEST_ASSERT_TRUE(said.distance[k] >= 0);
        point_f32 x[EDML_JOINTS], sum = {0, 0, 0};
        from_points(x, said.x);
        for (int j = 0; j < EDML_JOINTS; j++) {
            TEST_ASSERT_TRUE(from_real(said.share[j]) >= 0 && from_real(said.share[j]) <= 1);
            sum.x += x[j].x;
            sum.y += x[j].y;
            sum.z += x[j].z;
        }
        TEST_ASSERT_ERROR_UP_TO(1e-5F + ROUNDING, fabsf(sum.x) + fabsf(sum.y) + fabsf(sum.z));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(inputs_are_as_defined);
    RUN_TEST(no_input_is_beyond_8);
    RUN_TEST(fconn_reads_the_edm);
    RUN_TEST(rows_of_direct_become_points_about_their_mean_and_shares);
    RUN_TEST(rows_of_distances_become_distances_points_and_shares);
    RUN_TEST(without_gates_all_shares_are_the_models);
    RUN_TEST(mirrored_people_are_mirrored);
    RUN_TEST(up_is_turned_to_the_bodys_frame);
    RUN_TEST(without_up_down_does_not_matter_and_up_does);
    RUN_TEST(predictions_are_in_range);
    return UNITY_END();
}
