/* A detector's keypoints to the 14 joints.
 *
 * Limbs are copied.  The models were trained with head and neck base where CMU's skeletons have them: the head
 * at the height of the ears, the neck base below the line of the shoulders.  Detectors call three other points
 * head and four other points neck.  So this does not look at a detector's neck, and takes its head only as
 * evidence.
 *
 * tools/fitting/adapters.py fits the numbers below.  It models heads, so trust their second digit little.  In
 * fixed point they must be under 1.5: |s + k (e - s)| < (1 + 2 k) 2^29 then fits 31 bits.
 *
 * SPDX-License-Identifier: MIT
 */

#ifndef EDML_ADAPT_H
#define EDML_ADAPT_H

#include "../api/api.h"

/* Head = s + k (e - s), from between the shoulders past the evidence e. */
#define BOTH_EARS REAL(1.00)
#define CROWN REAL(0.64)
#define CENTRE REAL(1.02)
#define ONE_EAR REAL(0.97)
#define FACE REAL(0.95)

/* Neck base = s + k (h - s), from between the shoulders towards between the hips. */
#define TRUNK REAL(0.12)

static const edml_keypoint unseen_keypoint = {0, 0, 0};

/* A keypoint that is not sound must reach edml_lift(), which refuses it. */
static int is_sound(edml_keypoint p)
{
    return IS_FINITE((real)p.c) && (!(p.c > 0) || (IS_FINITE(p.x) && IS_FINITE(p.y)));
}

static confidence lower_confidence(confidence a, confidence b) { return a < b ? a : b; }

/* The mean of the seen ones among up to three keypoints, with the lowest of their confidences.  Returns
 * unseen_keypoint if fewer than `fewest` were seen, and the first that is not sound if there is one. */
static edml_keypoint mean_keypoint(const edml_keypoint in[], const uint8_t index[], int count, int fewest)
{
    edml_keypoint sum = unseen_keypoint; /* |x| < 3 * 2^29 */
    int seen = 0;
    for (int n = 0; n < count; n++) {
        if (index[n] == EDML_NO_KEYPOINT) continue;
        const edml_keypoint p = in[index[n]];
        if (!is_sound(p)) return p;
        if (!(p.c > 0)) continue;
        sum.c = seen == 0 ? p.c : lower_confidence(sum.c, p.c);
        sum.x += p.x;
        sum.y += p.y;
        seen++;
    }
    if (seen == 0 || seen < fewest) return unseen_keypoint;
    sum.x /= (pixels)seen;
    sum.y /= (pixels)seen;
    return sum;
}

/* s + k (e - s), with half the lower confidence, because it is a guess.  Both were seen. */
static edml_keypoint keypoint_along(edml_keypoint s, edml_keypoint e, real k)
{
    if (!is_sound(s)) return s;
    if (!is_sound(e)) return e;
    edml_keypoint p = {s.x + MUL(k, e.x - s.x), s.y + MUL(k, e.y - s.y), lower_confidence(s.c, e.c)};
    p.c = (confidence)(p.c - p.c / 2); /* the lowest confidence stays above 0 */
    return p;
}

/* The head from the best evidence there is, in the order of its error. */
static edml_keypoint head_of(const edml_keypoint in[], const edml_format *format, edml_keypoint s)
{
    const struct {
        const uint8_t *index;
        int count, fewest;
        real k;
    } evidence[] = {
        {format->ears, 2, 2, BOTH_EARS}, {&format->crown, 1, 1, CROWN}, {&format->centre, 1, 1, CENTRE},
        {format->ears, 2, 1, ONE_EAR},   {format->face, 3, 1, FACE},
    };
    for (unsigned n = 0; n < sizeof evidence / sizeof *evidence; n++) {
        const edml_keypoint e = mean_keypoint(in, evidence[n].index, evidence[n].count, evidence[n].fewest);
        if (e.c != 0) return keypoint_along(s, e, evidence[n].k);
    }
    return unseen_keypoint;
}

void edml_adapt(edml_keypoint out[EDML_JOINTS], const edml_keypoint in[], const edml_format *format)
{
    static const uint8_t shoulders[] = {EDML_R_SHOULDER, EDML_L_SHOULDER};
    static const uint8_t hips[] = {EDML_R_HIP, EDML_L_HIP};
    for (int j = EDML_R_SHOULDER; j < EDML_JOINTS; j++) {
        const uint8_t from = format->limb[j - EDML_R_SHOULDER];
        out[j] = from != EDML_NO_KEYPOINT ? in[from] : unseen_keypoint;
    }
    const edml_keypoint s = mean_keypoint(out, shoulders, 2, 2), h = mean_keypoint(out, hips, 2, 2);
    out[EDML_HEAD] = s.c != 0 ? head_of(in, format, s) : unseen_keypoint;
    out[EDML_NECK_BASE] = s.c != 0 ? keypoint_along(s, h.c != 0 ? h : s, TRUNK) : unseen_keypoint;
}

#endif
