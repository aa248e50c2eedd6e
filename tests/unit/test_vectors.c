/* Every stage against NumPy in double (tests/vectors/make_vectors.py).  Where this alone fails after a
 * change of the network, vectors.h is of the old one: run tests/vectors/make_vectors.py.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>

#include "as_float.h"
#include "network/model.h"
#include "vectors.h"

static edml_work work;
static edml_keypoint in[EDML_JOINTS];
static edml_point x[EDML_JOINTS], up;
static edml_prediction said;
static edml_image image;
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
    to_floats(&up.x, v->up, 3);
}

/* In the camera's axes, of any length; NULL: not known. */
static const edml_point *upwards(void) { return up.x == 0 && up.y == 0 && up.z == 0 ? NULL : &up; }

/* The image of a vector; and up as a unit vector. */
static void load_image(const lift_vector *v)
{
    load_keypoints(v);
    memset(&image, 0, sizeof image);
    for (int j = 0; j < EDML_JOINTS; j++) {
        to_floats(&image.at[j].u, v->at[j], 2);
        if (in[j].c > 0) image.seen = (uint16_t)(image.seen | 1 << j);
    }
    to_floats(&image.down.u, v->down, 2);
    if (upwards() == NULL) return;
    const float length = sqrtf(up.x * up.x + up.y * up.y + up.z * up.z);
    up.x /= length;
    up.y /= length;
    up.z /= length;
}

static void report(const char *what, float worst)
{
    printf("against NumPy, worst: %s %.3g\n", what, (double)worst);
}

/* ---- Models ---------------------------------------------------------------------------------- */

static void check_frames(const lift_vector *vectors, const edml_model *model, const char *name)
{
    float worst = 0;
    for (int n = 0; n < LIFTS; n++) {
        load_keypoints(&vectors[n]);
        TEST_ASSERT_EQUAL_INT(EDML_OK,
                              edml_body_frame(&image, in, model->fewest_joints, model->imputation));
        worst = worse(worst, worst_difference(&image.at[0].u, vectors[n].at[0], 2 * EDML_JOINTS));
        worst = worse(worst, worst_difference(&image.down.u, vectors[n].down, 2));
    }
    report(name, worst);
    TEST_ASSERT_ERROR_UP_TO(VECTOR_FRAME_TOLERANCE, worst);
}

static void frames(void)
{
    check_frames(distances_lifts, &edml_distances_f32, "frames, distances");
    check_frames(direct_lifts, &edml_direct_f32, "frames, direct");
    check_frames(fconn_lifts, &edml_fconn_f32, "frames, fconn");
}

static void check_network(const lift_vector *vectors, const edml_model *model, const char *name)
{
    float worst = 0, worst_share = 0;
    for (int n = 0; n < LIFTS; n++) {
        const lift_vector *const v = &vectors[n];
        load_image(v);
        memset(&said, 0, sizeof said);
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_predict(&said, &image, upwards(), model, &work, sizeof work));
        if (model->gives & EDML_GIVES_DISTANCES)
            worst = worse(worst, worst_difference(said.distance, v->distance, EDML_PAIRS));
        if (model->gives & EDML_GIVES_POINTS)
            worst = worse(worst, worst_difference(&said.x[0].x, v->x[0], 3 * EDML_JOINTS));
        worst_share = worse(worst_share, worst_difference(said.share, v->share, EDML_JOINTS));
    }
    report(name, worst);
    report("shares", worst_share);
    TEST_ASSERT_ERROR_UP_TO(VECTOR_NET_TOLERANCE, worst);
    TEST_ASSERT_ERROR_UP_TO(VECTOR_SHARE_TOLERANCE, worst_share);
}

static void networks(void)
{
    check_network(distances_lifts, &edml_distances_f32, "distances, m");
    check_network(direct_lifts, &edml_direct_f32, "direct, m");
    check_network(fconn_lifts, &edml_fconn_f32, "fconn, m");
}

static void check_lifts(const lift_vector *vectors, const edml_model *model, const char *name)
{
    float worst = 0, worst_misfit = 0;
    for (int n = 0; n < LIFTS; n++) {
        const lift_vector *v = &vectors[n];
        edml_pose pose;
        load_keypoints(v);
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_lift(&pose, in, upwards(), model, &work, sizeof work));
        worst = worse(worst, worst_difference(&pose.joint[0].x, v->pose[0], 3 * EDML_JOINTS));
        worst_misfit = worse(worst_misfit, worst_difference(&pose.misfit, &v->misfit, 1));
    }
    report(name, worst);
    report("misfit, m", worst_misfit);
    TEST_ASSERT_ERROR_UP_TO(VECTOR_POSE_TOLERANCE, worst);
    TEST_ASSERT_ERROR_UP_TO(VECTOR_POSE_TOLERANCE, worst_misfit);
}

static void lifts(void)
{
    check_lifts(distances_lifts, &edml_distances_f32, "lifts, distances, m");
    check_lifts(direct_lifts, &edml_direct_f32, "lifts, direct, m");
    check_lifts(fconn_lifts, &edml_fconn_f32, "lifts, fconn, m");
}

/* ---- Stages of distances ----------------------------------------------------------------------- */

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

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(frames);
    RUN_TEST(networks);
    RUN_TEST(lifts);
    RUN_TEST(eigenvalues);
    RUN_TEST(mds);
    RUN_TEST(refinement_of_s_stress);
    RUN_TEST(refinement_of_raw_stress);
    RUN_TEST(refinement_of_eq2);
    return UNITY_END();
}
