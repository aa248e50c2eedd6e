/* The torso's front, and the nine bones that move against the torso.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_TORSO_H
#define EDML_TORSO_H

#include "vector.h"

enum { ARMS, FOREARMS, HEAD, THIGHS, SHINS };
enum { OUTER_BONES = 9 };

/* Right and left alternate; a forearm and a shin come two after the bone that they hang on. */
static const struct {
    uint8_t from, to, kind;
} outer_bones[OUTER_BONES] = {
    {EDML_NECK_BASE, EDML_HEAD, HEAD},      {EDML_R_SHOULDER, EDML_R_ELBOW, ARMS},
    {EDML_L_SHOULDER, EDML_L_ELBOW, ARMS},  {EDML_R_ELBOW, EDML_R_WRIST, FOREARMS},
    {EDML_L_ELBOW, EDML_L_WRIST, FOREARMS}, {EDML_R_HIP, EDML_R_KNEE, THIGHS},
    {EDML_L_HIP, EDML_L_KNEE, THIGHS},      {EDML_R_KNEE, EDML_R_ANKLE, SHINS},
    {EDML_L_KNEE, EDML_L_ANKLE, SHINS},
};

/* Normal of the torso, from its back to its front: (toward the subject's left) x (upward).  Zero if the
 * torso has no front.  Vectors here are under 11 m for points of any distances up to 3 m, and under 14 m
 * for poses within 4 m on each axis. */
static point forward(const point x[EDML_JOINTS], int right, int left)
{
    const point up = minus(x[EDML_NECK_BASE], midpoint(x[EDML_R_HIP], x[EDML_L_HIP]));
    return direction(cross(direction(minus(x[left], x[right])), direction(up)));
}

#endif
