/* The most instructions of a lift over people in all positions and what is hardly one: joints far off, missing,
 * on a line, at one place, upside down, tiny and huge.  Prints the instructions, and how many were lifted.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>
#include <stdlib.h>

#include "lift.h"

#include "measure.h"

#ifndef INPUTS
#define INPUTS 240
#endif

enum { KINDS = 8 };

static uint32_t seed = 1;

/* From -1 to 1, Q16. */
static int32_t draw(void)
{
    seed = seed * 1664525U + 1013904223U;
    return (int32_t)(seed >> 15) - 65536;
}

/* Pixels, Q16: a person of 170 pixels, each joint off by up to `noise` of them. */
static void draw_places(int32_t at[EDML_JOINTS][2], int noise)
{
    static const int8_t person[EDML_JOINTS][2] = {
        {0, -80},   {0, -56},   {-18, -50}, {-25, -23}, {-22, -8}, {18, -50}, {27, -24},
        {24, -12},  {-13, 0},   {-15, 42},  {-16, 84},  {13, 0},   {15, 43},  {17, 85}};
    for (int j = 0; j < EDML_JOINTS; j++)
        for (int k = 0; k < 2; k++) at[j][k] = person[j][k] * 65536 + noise * draw();
}

/* What is hardly a person, by its kind. */
static void spoil(int32_t at[EDML_JOINTS][2], int kind)
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (kind == 1) at[j][1] = -at[j][1];                        /* upside down */
        if (kind == 2) at[j][0] = at[j][0] / 64;                    /* nearly on a line */
        if (kind == 3 && j % 2) at[j][0] = at[0][0], at[j][1] = at[0][1]; /* many at one place */
        if (kind == 4) at[j][1] = at[0][1];                         /* flat */
        if (kind == 5) at[j][0] /= 256, at[j][1] /= 256;            /* tiny */
        if (kind == 6) at[j][0] *= 32, at[j][1] *= 32;              /* huge */
        if (kind == 7) at[j][0] = at[EDML_JOINTS - 1 - j][0];       /* joints exchanged */
    }
}

static void make_input(int n)
{
    static const uint8_t noises[] = {1, 5, 15, 40, 100};
    int32_t at[EDML_JOINTS][2];
    int missing = n % 3 == 0 ? n / 3 % 5 : 0;
    draw_places(at, noises[n % 5]);
    spoil(at, n / 5 % KINDS);
    for (int j = 0; j < EDML_JOINTS; j++) {
        const int seen = missing <= 0 || draw() > 0;
        missing -= !seen;
#ifdef FIXED
        const edml_keypoint k = {at[j][0], at[j][1], seen ? 32767 : 0};
#else
        const edml_keypoint k = {(float)at[j][0] / 65536.0F, (float)at[j][1] / 65536.0F, (float)seen};
#endif
        in[j] = k;
    }
}

STAGE nothing(void) {}

int main(void)
{
    uint32_t most = 0;
    int lifted = 0;
    for (int n = 0; n < INPUTS; n++) {
        make_input(n);
        out.seen = 0;
        const uint32_t took = counts(stage_lift) - counts(nothing);
        if (took > most) most = took;
        lifted += out.seen != 0;
    }
    printf("%lu %d\n", (unsigned long)((uint64_t)most * 1000 / COUNTS_PER_1000), lifted);
    return 0;
}
