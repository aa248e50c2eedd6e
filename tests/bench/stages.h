/* The stages on made-up poses, each in a function of its own so that its cost can be told.
 *
 * MODEL is the model; with -DFIXED everything is in fixed point.
 *
 * SPDX-License-Identifier: MIT
 */
#ifdef FIXED
#include "real_q24.h"
#else
#include "real_f32.h"
#endif

#ifndef MODEL
#define MODEL edml_fconn_f32
#endif

#define STAGE static __attribute__((noinline)) void

enum { POSES = 64, STEPS = 10 };

static keypoint in[EDML_JOINTS];
static real edm[EDML_PAIRS], distance[EDML_PAIRS];
static point x[EDML_JOINTS];
static pose out;
#ifndef FIXED
static placement placed;
#endif
static work_memory work;

/* A person of about 400 pixels' height, each joint off by up to 20 pixels. */
static void make_pose(int i)
{
    static const int16_t person[EDML_JOINTS][2] = {
        {512, 240}, {508, 301}, {461, 318}, {452, 387}, {489, 440}, {556, 317}, {571, 389},
        {561, 447}, {478, 466}, {470, 561}, {463, 655}, {537, 465}, {551, 556}, {590, 640}};
    uint32_t seed = 2654435761U * (uint32_t)(i + 1);
    for (int j = 0; j < EDML_JOINTS; j++) {
        int32_t at[2]; /* pixels, Q16 */
        for (int k = 0; k < 2; k++) {
            seed = seed * 1664525U + 1013904223U;
            at[k] = (person[j][k] - 20) * 65536 + (int32_t)(seed >> 16) * 40;
        }
#ifdef FIXED
        const keypoint seen = {at[0], at[1], 32767};
#else
        const keypoint seen = {(float)at[0] / 65536.0F, (float)at[1] / 65536.0F, 1.0F};
#endif
        in[j] = seen;
    }
}

STAGE stage_edm(void) { NAME(edml_edm)(edm, in, 10, SETTING(MODEL.widest)); }
STAGE stage_net(void) { NAME(edml_net)(distance, edm, &MODEL, &work); }
STAGE stage_mds(void) { NAME(edml_mds)(x, distance, &work); }
STAGE stage_refine(void) { NAME(edml_refine)(x, distance, EDML_STRESS_SQUARE, STEPS, &work); }
STAGE stage_mirror(void) { NAME(edml_mirror)(x, &MODEL); }
STAGE stage_orient(void) { NAME(edml_orient)(x, in, 0x3FFF); }
STAGE stage_lift(void) { NAME(edml_lift)(&out, in, &MODEL, &work); }
#ifndef FIXED
STAGE stage_place(void) /* after the lift */
{
    static const camera by = {1145, 1145, 500, 500};
    NAME(edml_place)(&placed, &out, in, &by, &work);
}
#endif

/* In the order in which data flow; the shipped models' lift goes without the refinement. */
static const struct {
    const char *name;
    void (*run)(void);
} stages[] = {
    {"edm", stage_edm},       {"net", stage_net},       {"mds", stage_mds},   {"refine", stage_refine},
    {"mirror", stage_mirror}, {"orient", stage_orient}, {"lift", stage_lift},
#ifndef FIXED
    {"place", stage_place},
#endif
};
enum { STAGES = (int)(sizeof stages / sizeof stages[0]) };
