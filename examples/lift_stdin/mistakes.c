/* Likely mistakes: what a whole run shows of them.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdio.h>

#include "lift_stdin.h"

enum { FEWEST = 5 }; /* poses, before anything is said */
#define LOW_QUALITY 0.2F

static struct {
    unsigned long poses, poor;   /* lifted; of low quality */
    unsigned long trunks, lying; /* with hips and shoulders seen; more horizontal than vertical */
    unsigned long frames, near;  /* with a time; within a second of the one before */
    int beyond;                  /* a coordinate is not a share */
    double time;
} seen;

static edml_point middle(edml_keypoint a, edml_keypoint b)
{
    const edml_point p = {(a.x + b.x) / 2, (a.y + b.y) / 2, a.c > 0 && b.c > 0 ? 1 : 0};
    return p;
}

static void note_trunk(const edml_keypoint joints[EDML_JOINTS])
{
    const edml_point shoulders = middle(joints[EDML_R_SHOULDER], joints[EDML_L_SHOULDER]);
    const edml_point hips = middle(joints[EDML_R_HIP], joints[EDML_L_HIP]);
    if (shoulders.z == 0 || hips.z == 0) return;
    seen.trunks++;
    seen.lying += fabsf(shoulders.x - hips.x) > fabsf(shoulders.y - hips.y) ? 1U : 0U;
}

static void note_time(double time)
{
    if (seen.frames > 0 && time == seen.time) return; /* another person of the frame */
    if (seen.frames++ > 0 && fabs(time - seen.time) <= 1) seen.near++;
    seen.time = time;
}

void note_pose(const person *who, const edml_keypoint joints[EDML_JOINTS], float quality,
               const options *set)
{
    seen.poses++;
    seen.poor += quality < LOW_QUALITY ? 1U : 0U;
    note_trunk(joints);
    if (set->track && set->fps == 0) note_time(who->time);
    for (int n = 0; n < keypoints_of(set) && !seen.beyond; n++) {
        const edml_keypoint at = who->in[n];
        seen.beyond = at.c > 0 && !(at.x >= 0 && at.x <= 1 && at.y >= 0 && at.y <= 1);
    }
}

static void warn(const char *what) { fprintf(stderr, "lift_stdin: warning: %s\n", what); }

void print_warnings(const options *set)
{
    const int normalised = set->format != NULL && set->format->normalised != EDML_NOT_NORMALISED;
    if (seen.poses < FEWEST) return;
    if (seen.trunks >= FEWEST && 10 * seen.lying > 9 * seen.trunks)
        warn("people lie on their side in over 90 % of the poses: is y before x in your input? Exchange "
             "them "
             "(MoveNet's own output: --format movenet17). If the camera is on its side, or people lie, all "
             "is "
             "well");
    if (!seen.beyond && !normalised)
        warn("all coordinates are within 0 and 1: are they shares of the image's size? Multiply x by its "
             "width "
             "and y by its height, or name a format that has them: blazepose33, movenet17");
    if (2 * seen.poor > seen.poses)
        warn("most poses have a quality under 0.2: is --format that of your keypoints, in their order? "
             "docs/detectors.md shows the orders");
    if (seen.frames >= FEWEST && seen.near == 0)
        warn("no two frames are within a second: are the times \"t\" milliseconds? Give seconds");
}
