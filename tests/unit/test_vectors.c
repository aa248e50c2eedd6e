/* Every stage against NumPy in double (tests/vectors/make_vectors.py).  Where this alone fails after a
 * change of the network, vectors.h is of the old one: run tests/vectors/make_vectors.py.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>

#include "as_float.h"
#include "vectors.h"

static edml_work work;
static edml_keypoint in[EDML_JOINTS];
static edml_point x[EDML_JOINTS];
static float values[EDML_PAIRS];

static void to_floats(float *to, const double *from, int count)
{
    for (int n = 0; n < count; n++) to[n] = (float)from[n];
}

static float worst_difference(const float *actual, const double *expected, int count)
{
    float worst = 0;
    for (int n = 0; n < count; n++) worst = worse(worst, (float)fabs((double)actual[n] - expected[n]));
    return worst;
}

static void load_keypoints(const lift_vector *v)
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        in[j].x = (float)v->in[j][0];
        in[j].y = (float)v->in[j][1];
        in[j].c = (float)v->in[j][2];
    }
}

static void report(const char *what, float worst)
{
    printf("against NumPy, worst: %s %.3g\n", what, (double)worst);
}

static void edm(void)
{
    float worst = 0;
    for (int n = 0; n < LIFTS; n++) {
        load_keypoints(&lift_vectors[n]);
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_edm(values, in, 4, 100, &edml_default_imputation));
        worst = worse(worst, worst_difference(values, lift_vectors[n].edm, EDML_PAIRS));
    }
    report("edm", worst);
    TEST_ASSERT_ERROR_UP_TO(VECTOR_EDM_TOLERANCE, worst);
}

static void net(void)
{
    float worst = 0, input[EDML_PAIRS];
    for (int n = 0; n < LIFTS; n++) {
        to_floats(input, lift_vectors[n].edm, EDML_PAIRS);
        edml_predict(values, input, &edml_fconn_f32, &work, sizeof work);
        worst = worse(worst, worst_difference(values, lift_vectors[n].net, EDML_PAIRS));
    }
    report("network, m", worst);
    TEST_ASSERT_ERROR_UP_TO(VECTOR_NET_TOLERANCE, worst);
}

static void eigenvalues(void)
{
    float worst = 0;
    for (int n = 0; n < EIGENS; n++) {
        const eigen_vector *v = &eigen_vectors[n];
        static edml_matrix a;
        static edml_eigen e;
        const double *from = v->matrix;
        for (int i = 0; i < EDML_JOINTS; i++)
            for (int j = i; j < EDML_JOINTS; j++) a.at[i][j] = (float)*from++;
        edml_jacobi(&e, &a);
        const float largest = (float)fmax(v->value[0], -v->value[EDML_JOINTS - 1]);
        worst = worse(worst, worst_difference(e.value, v->value, EDML_JOINTS) / largest);
    }
    report("eigenvalues, relative", worst);
    TEST_ASSERT_ERROR_UP_TO(VECTOR_EIGEN_TOLERANCE, worst);
}

static void mds(void)
{
    float worst = 0, distance[EDML_PAIRS];
    for (int n = 0; n < SHAPES; n++) {
        to_floats(distance, shape_vectors[n].distance, EDML_PAIRS);
        edml_mds(x, distance, &work);
        pair_distances(values, x);
        worst = worse(worst, worst_difference(values, shape_vectors[n].mds, EDML_PAIRS));
    }
    report("mds, m", worst);
    TEST_ASSERT_ERROR_UP_TO(VECTOR_MDS_TOLERANCE, worst);
}

static void check_refinement(edml_objective objective, int row, const char *name, float tolerance)
{
    float worst = 0, distance[EDML_PAIRS];
    for (int n = 0; n < SHAPES; n++) {
        to_floats(distance, shape_vectors[n].distance, EDML_PAIRS);
        edml_mds(x, distance, &work);
        edml_refine(x, distance, objective, VECTOR_STEPS, &work);
        pair_distances(values, x);
        worst = worse(worst, worst_difference(values, shape_vectors[n].refined[row], EDML_PAIRS));
    }
    report(name, worst);
    TEST_ASSERT_ERROR_UP_TO(tolerance, worst);
}

static void refinement_of_s_stress(void)
{
    check_refinement(EDML_STRESS_SQUARE, 0, "refined, s-stress, m", VECTOR_SQUARE_TOLERANCE);
}

static void refinement_of_raw_stress(void)
{
    check_refinement(EDML_STRESS_RAW, 1, "refined, raw stress, m", VECTOR_RAW_TOLERANCE);
}

static void refinement_of_eq2(void)
{
    check_refinement(EDML_STRESS_EQ2, 2, "refined, eq. 2, m", VECTOR_EQ2_TOLERANCE);
}

static void lift(void)
{
    float worst = 0, worst_margin = 0, worst_residual = 0;
    for (int n = 0; n < LIFTS; n++) {
        const lift_vector *v = &lift_vectors[n];
        edml_pose pose;
        load_keypoints(v);
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_lift(&pose, in, &edml_fconn_f32, &work, sizeof work));
        worst = worse(worst, worst_difference(&pose.joint[0].x, v->pose[0], 3 * EDML_JOINTS));
        worst_margin = worse(worst_margin, worst_difference(&pose.mirror_margin, &v->margin, 1));
        worst_residual = worse(worst_residual, worst_difference(&pose.residual, &v->residual, 1));
    }
    report("lift, m", worst);
    report("margin, log-odds", worst_margin);
    report("residual, m", worst_residual);
    TEST_ASSERT_ERROR_UP_TO(VECTOR_POSE_TOLERANCE, worst);
    TEST_ASSERT_ERROR_UP_TO(VECTOR_MARGIN_TOLERANCE, worst_margin);
    TEST_ASSERT_ERROR_UP_TO(VECTOR_POSE_TOLERANCE, worst_residual);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(edm);
    RUN_TEST(net);
    RUN_TEST(eigenvalues);
    RUN_TEST(mds);
    RUN_TEST(refinement_of_s_stress);
    RUN_TEST(refinement_of_raw_stress);
    RUN_TEST(refinement_of_eq2);
    RUN_TEST(lift);
    return UNITY_END();
}
