/* Measures the bones of one person from the poses of a video.
 *
 * A lift makes a bone a tenth too long, and in the next pose a tenth too short.  Its length is the mean of all
 * poses so far, and of a first estimate that counts for PRIOR_POSES.  No pose is taken to be off by more than
 * MAX_NEWS of it, so that a few bad ones do little (Huber's mean).
 *
 * tools/evaluation/room.py measures what that does to a video.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_MEASURE_BODY_H
#define EDML_MEASURE_BODY_H

#include <string.h>

#include "body.h"

#define HALF_OF_PROPORTIONS REAL(1.2595) /* half the sum of all bones', relative to the height */

#define MIN_MEASURED REAL(0.52) /* metres, standing height: all stay within those of edml_fit_body() */
#define MAX_MEASURED REAL(2.4)
#define MAX_UNLIKE REAL(1.25) /* times the whole body's, or less by that: 1.25^2 < MAX_HEIGHT_RATIO */

enum { PRIOR_POSES = 8 };  /* that the first estimate counts for */
#define MAX_NEWS REAL(0.1) /* of the bone */

/* The bone of the other side; the head's is itself. */
static int mirror_bone(int bone)
{
    const int joint = edml_mirror_joint[edml_bones[bone].to];
    return joint == EDML_HEAD ? HEAD_BONE : joint - 1; /* edml_bones is in the order of the joints */
}

static real limit_between(real value, real least, real most)
{
    return value < least ? least : value > most ? most : value;
}

/* The standing height that bones with halves of these lengths add up to: <= 13 * 7 / 1.2595. */
static real height_of_halves(const real half[EDML_BONES])
{
    real sum = 0;
    for (int n = 0; n < EDML_BONES; n++) sum += half[n];
    return DIV(sum, HALF_OF_PROPORTIONS);
}

/* What a pose's bone and that of the other side, as far as they were seen, add to a length: the mean, each no
 * more than `most`.  Counts them. */
static real bone_news(const edml_pose *pose, const real half[EDML_BONES], int bone, real length, real most,
                      int *seen)
{
    const int pair[2] = {bone, mirror_bone(bone)}, count = pair[0] == pair[1] ? 1 : 2;
    real news = 0;
    *seen = 0;
    for (int k = 0; k < count; k++) {
        const edml_bone *ends = &edml_bones[pair[k]];
        if (!(pose->seen >> ends->from & 1 && pose->seen >> ends->to & 1)) continue;
        news += limit_between(2 * half[pair[k]] - length, -most, most);
        ++*seen;
    }
    return *seen > 0 ? news / (real)*seen : 0;
}

/* The first estimate: half an average person's of the pose's size, half the pose's, within its double. */
static real first_length(const edml_pose *pose, const real half[EDML_BONES], int bone, real average)
{
    int seen;
    return average + bone_news(pose, half, bone, average, average, &seen) / 2;
}

/* Keeps a body's bones like one another: no more than MAX_UNLIKE from those of their mean height. */
static void limit_bones(real bone[EDML_BONES])
{
    real half[EDML_BONES];
    for (int n = 0; n < EDML_BONES; n++) half[n] = bone[n] / 2;
    const real height = limit_between(height_of_halves(half), MIN_MEASURED, MAX_MEASURED);
    const real least = limit_between(DIV(height, MAX_UNLIKE), MIN_MEASURED, MAX_MEASURED);
    const real most = limit_between(MUL(height, MAX_UNLIKE), MIN_MEASURED, MAX_MEASURED);
    for (int n = 0; n < EDML_BONES; n++)
        bone[n] = limit_between(bone[n], MUL(least, proportion[n]), MUL(most, proportion[n]));
}

void edml_measure_start(edml_measured_body *measured) { memset(measured, 0, sizeof *measured); }

edml_status edml_measure_body(edml_measured_body *measured, const edml_pose *pose)
{
    if (measured == NULL || pose == NULL) return EDML_ERR_ARGUMENT;
    if (!is_pose(pose)) return EDML_ERR_NOT_FINITE;
    real half[EDML_BONES], bone[EDML_BONES];
    for (int n = 0; n < EDML_BONES; n++) /* <= 4 sqrt(3) */
        half[n] = norm(minus(pose_joint(pose, edml_bones[n].to), pose_joint(pose, edml_bones[n].from))) / 2;
    const real height = height_of_halves(half);
    if (height < MIN_MEASURED || height > MAX_MEASURED) return EDML_ERR_DEGENERATE;
    if (measured->poses >= EDML_MEASURED_POSES) return EDML_OK;
    for (int n = 0; n < EDML_BONES; n++)
        bone[n] = measured->poses > 0 ? FROM_API(measured->body.bone[n])
                                      : first_length(pose, half, n, MUL(height, proportion[n]));
    for (int n = 0; n < EDML_BONES; n++) {
        const int other = mirror_bone(n);
        int seen;
        if (other < n) continue;
        const real news = bone_news(pose, half, n, bone[n], MUL(MAX_NEWS, bone[n]), &seen);
        if (seen == 0) continue;
        measured->seen[n] = measured->seen[other] = (uint8_t)(measured->seen[n] + 1);
        bone[n] += news / (real)(PRIOR_POSES + measured->seen[n]);
        bone[other] = bone[n];
    }
    limit_bones(bone);
    for (int n = 0; n < EDML_BONES; n++) measured->body.bone[n] = TO_API(bone[n]);
    measured->poses++;
    return EDML_OK;
}

#endif
