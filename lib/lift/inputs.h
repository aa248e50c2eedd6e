/* What an equivariant network reads, and what it gives.
 *
 * Each number stands for a joint or a pair of joints, and has a mirror number: the same with left for right.
 * A network reads the sums of the two (even) and their differences (odd), the even ones first.  What it gives
 * comes as a row and its mirror row (network/equivariant.h).  Joints in the middle, and pairs such as that of
 * the knees, are their own mirror images: they have a sum, twice themselves, and no difference.  A coordinate
 * x across the body changes its sign in the mirror, so that there sum and difference change places.
 *
 * All inputs are within +-8, which Q12 holds in 16 bits.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_INPUTS_H
#define EDML_INPUTS_H

#include "../geometry/centre.h"
#include "../geometry/seen.h"
#include "../geometry/vector.h"
#include "../network/model.h"
#include "edm.h"

enum {
    MIRROR_PAIRS = 49, /* of pairs of joints, of which the last SELF_MIRRORED are their own mirror pair */
    SELF_MIRRORED = 7,
    MIRROR_JOINTS = 8, /* the first MIDDLE_JOINTS of them are their own mirror joint */
    MIDDLE_JOINTS = 2
};

/* Pairs of joints and their mirror pairs, as EDML_PAIR numbers them. */
static const uint8_t mirror_pairs[MIRROR_PAIRS][2] = {
    {1, 4},   {2, 5},   {3, 6},   {7, 10},  {8, 11},  {9, 12},  {13, 16}, {14, 17}, {15, 18}, {19, 22},
    {20, 23}, {21, 24}, {25, 55}, {26, 56}, {28, 37}, {29, 46}, {30, 60}, {31, 61}, {32, 62}, {33, 57},
    {34, 58}, {35, 59}, {36, 63}, {39, 47}, {40, 67}, {41, 68}, {42, 69}, {43, 64}, {44, 65}, {45, 66},
    {49, 73}, {50, 74}, {51, 75}, {52, 70}, {53, 71}, {54, 72}, {76, 88}, {77, 89}, {79, 82}, {80, 85},
    {81, 90}, {84, 86}, {0, 0},   {27, 27}, {38, 38}, {48, 48}, {78, 78}, {83, 83}, {87, 87},
};

static const uint8_t mirror_joints[MIRROR_JOINTS] = {
    EDML_HEAD,    EDML_NECK_BASE, EDML_R_SHOULDER, EDML_R_ELBOW,
    EDML_R_WRIST, EDML_R_HIP,     EDML_R_KNEE,     EDML_R_ANKLE,
};

/* ---- Inputs -------------------------------------------------------------------------------------- */

#define LONGEST_2D REAL(7.99) /* distances in the image: longer ones count as this */
#define MIDDLE_SOFT REAL(3.5) /* of softened distances, which are 0 to 7.44: they are counted from it */
#define SOFTENING Q12(EDML_SOFTENING)
#define MISSING_INPUT REAL(0.7) /* of a joint that was not seen */

/* d^2 / (d + s) instead of d, s the softening: d - s + s^2 / (d + s).  A distance has a kink where two joints
 * are at the same place in the image, as those of a limb that points at the camera are, and noise makes it
 * longer. */
static INLINE_PRODUCTS real soften(real distance)
{
    const real d = distance < LONGEST_2D ? distance : LONGEST_2D;
    const real soft = d - SOFTENING + DIV16(SQUARE(SOFTENING), d + SOFTENING);
    ASSUME(-REAL(0.02) <= soft && soft <= REAL(7.46)); /* it rises with d: tests/proof/soften.c */
    return soft;
}

/* Where the next inputs go. */
typedef struct {
    real *even, *odd;
} input_ends;

static void add_distances(input_ends *end, const real edm[EDML_PAIRS])
{
    for (int k = 0; k < MIRROR_PAIRS - SELF_MIRRORED; k++) {
        const real first = soften(edm[mirror_pairs[k][0]]) - MIDDLE_SOFT;
        const real second = soften(edm[mirror_pairs[k][1]]) - MIDDLE_SOFT;
        *end->even++ = first + second;
        *end->odd++ = first - second;
    }
    for (int k = MIRROR_PAIRS - SELF_MIRRORED; k < MIRROR_PAIRS; k++)
        *end->even++ = 2 * (soften(edm[mirror_pairs[k][0]]) - MIDDLE_SOFT);
}

/* A number of each joint: sums to one side, differences to the other. */
static void add_joints(real **sum, real **difference, const real value[EDML_JOINTS])
{
    for (int k = 0; k < MIRROR_JOINTS; k++) {
        const int j = mirror_joints[k], mirror = edml_mirror_joint[j];
        *(*sum)++ = value[j] + value[mirror];
        if (k >= MIDDLE_JOINTS) *(*difference)++ = value[j] - value[mirror];
    }
}

static void add_image(input_ends *end, const edml_image *image)
{
    real value[EDML_JOINTS];
    for (int j = 0; j < EDML_JOINTS; j++) value[j] = image->at[j].u;
    add_joints(&end->odd, &end->even, value);
    for (int j = 0; j < EDML_JOINTS; j++) value[j] = image->at[j].v;
    add_joints(&end->even, &end->odd, value);
    for (int j = 0; j < EDML_JOINTS; j++) value[j] = is_seen(image->seen, j) ? 0 : MISSING_INPUT;
    add_joints(&end->even, &end->odd, value);
}

/* up: a unit vector in the camera's axes, or NULL. */
static void add_up(input_ends *end, const edml_image *image, const point *up)
{
    const point none = {0, -REAL(1.0), 0};
    const point p = up == NULL ? none : *up;
    const edml_image_point down = image->down;
    const real across = MUL(down.v, p.x) - MUL(down.u, p.y), along = MUL(down.u, p.x) + MUL(down.v, p.y);
    *end->even++ = up == NULL ? 0 : 2 * (along + REAL(1.0));
    *end->even++ = 4 * p.z;
    *end->even++ = up == NULL ? 0 : REAL(1.0);
    *end->odd++ = up == NULL ? 0 : 2 * across;
}

/* What the model reads.  edm: [91], work memory of networks that read distances. */
static EDML_NOINLINE void network_inputs(real *in, const edml_image *image, const point *up,
                                         const edml_model *model, real edm[EDML_PAIRS])
{
    input_ends end = {in, in + model->even_inputs};
    if (model->reads & EDML_READS_DISTANCES) {
        edml_edm(edm, image);
        add_distances(&end, edm);
    }
    add_image(&end, image);
    add_up(&end, image, up);
}

/* ---- Outputs ------------------------------------------------------------------------------------- */

#define GATE_SOFTNESS REAL(0.125)

/* The share of the image, 0 to 1, of a gate. */
static real gate_share(real gate)
{
    /* the divisor is the larger one */
    const real ratio = DIV_TO(REAL(1.0), gate, ABS(gate) + GATE_SOFTNESS);
    return (REAL(1.0) + ratio) / 2;
}

/* The image's share in each joint, from a row each. */
static void take_shares(real share[EDML_JOINTS], const real *row, const real *mirror_row)
{
    for (int k = 0; k < MIRROR_JOINTS; k++) {
        const int j = mirror_joints[k];
        share[j] = gate_share(row[k]);
        if (k >= MIDDLE_JOINTS) share[edml_mirror_joint[j]] = gate_share(mirror_row[k]);
    }
}

static void take_distances(real distance[EDML_PAIRS], const real *row, const real *mirror_row)
{
    for (int k = 0; k < MIRROR_PAIRS; k++) {
        distance[mirror_pairs[k][1]] = POSITIVE_PART(mirror_row[k]);
        distance[mirror_pairs[k][0]] = POSITIVE_PART(row[k]); /* of a pair that is its own: this one */
    }
}

/* Points about their mean, of which x changes its sign in the mirror.  |coordinate| <= 3 before and <= 6 after
 * that. */
static void take_points(point x[EDML_JOINTS], const real *row, const real *mirror_row)
{
    for (int k = 0; k < MIRROR_JOINTS; k++) {
        const int j = mirror_joints[k], y = MIRROR_JOINTS + k, z = 2 * MIRROR_JOINTS + k;
        const point p = {row[k], row[y], row[z]};
        const point in_mirror = {-mirror_row[k], mirror_row[y], mirror_row[z]};
        x[j] = p;
        if (k >= MIDDLE_JOINTS) x[edml_mirror_joint[j]] = in_mirror;
    }
    move_origin_to_mean(x);
}

/* From the network's rows, the mirror rows behind them. */
static EDML_NOINLINE void take_outputs(edml_prediction *out, const real *row, const edml_model *model)
{
    const real *mirror_row = row + EDML_ROWS * EDML_GROUPS(model->outputs);
    const int points = model->outputs - 4 * MIRROR_JOINTS, gates = model->outputs - MIRROR_JOINTS;
    if (model->gives & EDML_GIVES_DISTANCES) take_distances(out->distance, row, mirror_row);
    take_points(out->x, row + points, mirror_row + points);
    take_shares(out->share, row + gates, mirror_row + gates);
}

#endif
