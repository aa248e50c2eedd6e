/* The stages on made-up poses.
 *
 * SPDX-License-Identifier: MIT
 */
#include "lift.h"

/* What the network reads is no public stage: its text, under another name than the library's. */
#undef edml_edm
#define edml_edm bench_edm
#include "lift/inputs.h"

#if defined(FCONV) || defined(RP2040)
enum { POSES = 4, STEPS = 10 }; /* FConv's work hardly depends on the pose, and the model is slow */
#else
enum { POSES = 64, STEPS = 10 };
#endif

static edml_keypoint partly[EDML_JOINTS]; /* `in` without knees and ankles */
static edml_image image;
static edml_prediction said;
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

static edml_work *lift_work(void) { return (edml_work *)&work; }

STAGE stage_impute(void) { edml_body_frame(&image, partly, 10, MODEL.imputation); }
STAGE stage_frame(void) { edml_body_frame(&image, in, 10, MODEL.imputation); }
STAGE stage_inputs(void)
{
    real *const values = lift_work()->of.network.io.values;
    if (MODEL.reads & EDML_READS_BODY)
        network_inputs(values, &image, NULL, &MODEL, said.distance);
    else
        edml_edm(values, &image);
}
STAGE stage_network(void) { RUN_NETWORK(&MODEL, &work); }
STAGE stage_predict(void) { edml_predict(&said, &image, NULL, &MODEL, &work, sizeof work); }
STAGE stage_mds(void) { edml_mds(x, said.distance, lift_work()); }
STAGE stage_refine(void) { edml_refine(x, said.distance, EDML_STRESS_SQUARE, STEPS, lift_work()); }
STAGE stage_align(void) { edml_align(x, said.x, &MODEL); }
STAGE stage_orient(void) { edml_orient(x, &image); }
STAGE stage_mirror(void) { edml_mirror(x, &MODEL); }
STAGE stage_fuse(void)
{
    edml_fuse(MODEL.gives & EDML_GIVES_DISTANCES ? x : said.x, &image, said.share, &MODEL);
}

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

/* In the order of the data; the frame of joints that are partly imputed before that of all.  "predict" is
 * "inputs", "network", and what is made of its outputs.  The shipped models' lift goes without the refinement,
 * and each without some others, by what it gives: those that are for networks that give all of `given` and none
 * of `missing`. */
static const struct {
    const char *name;
    void (*run)(void);
    int given, missing;
} stages[] = {
    {"impute", stage_impute, 0, 0},
    {"frame", stage_frame, 0, 0},
    {"inputs", stage_inputs, 0, 0},
    {"network", stage_network, 0, 0},
    {"predict", stage_predict, 0, 0},
    {"mds", stage_mds, EDML_GIVES_DISTANCES, 0},
    {"refine", stage_refine, EDML_GIVES_DISTANCES, 0},
    {"align", stage_align, EDML_GIVES_DISTANCES | EDML_GIVES_POINTS, 0},
    {"orient", stage_orient, EDML_GIVES_DISTANCES, EDML_GIVES_POINTS},
    {"mirror", stage_mirror, EDML_GIVES_DISTANCES, EDML_GIVES_POINTS},
    {"fuse", stage_fuse, 0, 0},
    {"lift", stage_lift, 0, 0},
    {"place", stage_place, 0, 0},
    {"angles", stage_angles, 0, 0},
    {"measure_body", stage_measure_body, 0, 0},
    {"path_follow", stage_path_follow, 0, 0},
};
enum { STAGES = (int)(sizeof stages / sizeof stages[0]) };

static int has_stage(int s)
{
    return (MODEL.gives & stages[s].given) == stages[s].given && !(MODEL.gives & stages[s].missing);
}
