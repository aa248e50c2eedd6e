/* The stages on made-up poses, each in a function of its own so that its cost can be told.
 *
 * SPDX-License-Identifier: MIT
 */
#include "edmlift.h"

#define STAGE static __attribute__((noinline)) void

enum { POSES = 64 };

static edml_keypoint poses[POSES][EDML_JOINTS];
static float edm[EDML_PAIRS], distance[EDML_PAIRS];
static edml_point x[EDML_JOINTS], refined[EDML_JOINTS];
static edml_pose lifted[POSES];
static edml_placement placement;
static edml_work work;
static edml_matrix_f32 matrix;
static edml_eigen_f32 eigen;

/* People of about 400 pixels' height, each joint off by up to 20 pixels. */
static void make_poses(void)
{
    static const float person[EDML_JOINTS][2] = {
        {512, 240}, {508, 301}, {461, 318}, {452, 387}, {489, 440}, {556, 317}, {571, 389},
        {561, 447}, {478, 466}, {470, 561}, {463, 655}, {537, 465}, {551, 556}, {590, 640}};
    uint32_t seed = 1;
    for (int i = 0; i < POSES; i++) {
        for (int j = 0; j < EDML_JOINTS; j++) {
            float offset[2];
            for (int k = 0; k < 2; k++) {
                seed = seed * 1664525U + 1013904223U;
                offset[k] = (float)(seed >> 16) / 65536.0F * 40.0F - 20.0F;
            }
            poses[i][j].x = person[j][0] + offset[0];
            poses[i][j].y = person[j][1] + offset[1];
            poses[i][j].c = 1;
        }
    }
}

STAGE stage_edm(int i) { edml_edm_f32(edm, poses[i], 10, 100.0F); }
STAGE stage_net(int i) { (void)i, edml_net_f32(distance, edm, &edml_fconn_f32, &work); }
STAGE stage_mds(int i) { (void)i, edml_mds_f32(x, distance, &work); }
STAGE stage_mirror(int i) { (void)i, edml_mirror_f32(x, &edml_fconn_f32); }
STAGE stage_orient(int i) { edml_orient_f32(x, poses[i], 0x3FFF); }
STAGE stage_jacobi(int i)
{
    (void)i;
    for (int p = 0, k = 0; p < EDML_JOINTS; p++)
        for (int q = p + 1; q < EDML_JOINTS; q++) matrix.at[p][q] = distance[k++];
    edml_jacobi_f32(&eigen, &matrix);
}
STAGE stage_lift(int i) { edml_lift(&lifted[i], poses[i], &edml_fconn_f32, &work); }
STAGE stage_place(int i) /* after the lift */
{
    static const edml_camera camera = {1145, 1145, 500, 500};
    edml_place(&placement, &lifted[i], poses[i], &camera, &work);
}
STAGE stage_refine(int i)
{
    (void)i;
    for (int j = 0; j < EDML_JOINTS; j++) refined[j] = x[j];
    edml_refine_f32(refined, distance, EDML_STRESS_SQUARE, 10, &work);
}

/* In the order in which a lift runs them; the shipped model's lift needs neither the refinement nor
 * all eigenpairs. */
static const struct {
    const char *name;
    void (*run)(int pose);
} stages[] = {
    {"edm", stage_edm},       {"net", stage_net},       {"mds", stage_mds}, {"mirror", stage_mirror},
    {"orient", stage_orient}, {"refine", stage_refine}, {"jacobi", stage_jacobi}, {"lift", stage_lift},
    {"place", stage_place},
};
enum { STAGES = (int)(sizeof stages / sizeof stages[0]) };
