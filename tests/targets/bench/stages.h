/* The stages on made-up poses.
 *
 * SPDX-License-Identifier: MIT
 */
#include "lift.h"

#ifdef FCONV
enum { POSES = 4, STEPS = 10 }; /* its work hardly depends on the pose */
#else
enum { POSES = 64, STEPS = 10 };
#endif

static edml_keypoint partly[EDML_JOINTS]; /* `in` without knees and ankles */
static real edm[EDML_PAIRS], distance[EDML_PAIRS];
static point x[EDML_JOINTS];
static edml_placement placed;

/* A person of about 400 pixels' height, each joint off by up to 20 pixels. */
static void make_pose(int i)
{
    static const int16_t person[EDML_JOINTS][2] = {
        {512, 240}, {508, 301}, {461, 318}, {452, 387}, {489, 440}, {556, 317}, {571, 389},
        {561, 447}, {478, 466}, {470, 561}, {463, 655}, {537, 465}, {551, 556}, {590, 640}};
    static const edml_keypoint unseen = {0, 0, 0};
    uint32_t seed = 2654435761U * (uint32_t)(i + 1);
    for (int j = 0; j < EDML_JOINTS; j++) {
        int32_t at[2]; /* pixels, Q16 */
        for (int k = 0; k < 2; k++) {
            seed = seed * 1664525U + 1013904223U;
            at[k] = (person[j][k] - 20) * 65536 + (int32_t)(seed >> 16) * 40;
        }
#ifdef FIXED
        const edml_keypoint seen = {at[0], at[1], 32767};
#else
        const edml_keypoint seen = {(float)at[0] / 65536.0F, (float)at[1] / 65536.0F, 1.0F};
#endif
        in[j] = partly[j] = seen;
    }
    partly[EDML_R_KNEE] = partly[EDML_R_ANKLE] = partly[EDML_L_KNEE] = partly[EDML_L_ANKLE] = unseen;
}

static void edm_of(const edml_keypoint joints[EDML_JOINTS])
{
    edml_edm(edm, joints, 10, PARAM(MODEL.max_aspect), MODEL.imputation);
}

STAGE stage_impute(void) { edm_of(partly); }
STAGE stage_edm(void) { edm_of(in); }
STAGE stage_predict(void) { edml_predict(distance, edm, &MODEL, &work, sizeof work); }
STAGE stage_mds(void) { edml_mds(x, distance, (edml_work *)&work); }
STAGE stage_refine(void) { edml_refine(x, distance, EDML_STRESS_SQUARE, STEPS, (edml_work *)&work); }
STAGE stage_mirror(void) { edml_mirror(x, &MODEL); }
STAGE stage_orient(void) { edml_orient(x, in, 0x3FFF); }
STAGE stage_fuse(void) { edml_fuse(x, in, 0x3FFF, &MODEL); }

/* What lift.h lifted, before a camera with a focal length of 1145 pixels. */
STAGE stage_place(void)
{
#ifdef FIXED
    static const edml_camera camera = {1145 << 16, 1145 << 16, 500 << 16, 500 << 16};
#else
    static const edml_camera camera = {1145, 1145, 500, 500};
#endif
    edml_place(&placed, &out, in, &camera, &work, sizeof work);
}

/* In the order of the data; the EDM of joints that are partly imputed before that of all.  The shipped
 * models' lift goes without the refinement. */
static const struct {
    const char *name;
    void (*run)(void);
} stages[] = {
    {"impute", stage_impute}, {"edm", stage_edm},       {"predict", stage_predict},
    {"mds", stage_mds},       {"refine", stage_refine}, {"mirror", stage_mirror},
    {"orient", stage_orient}, {"fuse", stage_fuse},     {"lift", stage_lift},
    {"place", stage_place},
};
enum { STAGES = (int)(sizeof stages / sizeof stages[0]) };
