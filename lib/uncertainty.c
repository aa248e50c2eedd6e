/* How far off are joints, given which were seen?  Means over training people with an imitated
 * detector's noise: tools/fit_person.py.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stddef.h>

#include "edmlift.h"

enum { MOST_MISSING = 4 };

typedef struct {
    uint8_t seen[MOST_MISSING + 1]; /* millimetres, by how many joints were not seen */
    uint8_t alone;                  /* not seen, while all its neighbours were */
    uint8_t lost[MOST_MISSING - 1]; /* not seen, nor a neighbour, by how many were not: from 2 on */
} joint_error;

static const joint_error head = {{57, 61, 65, 69, 78}, 80, {76, 82, 88}};
static const joint_error neck = {{32, 35, 38, 41, 48}, 40, {37, 43, 45}};
static const joint_error shoulder = {{42, 46, 49, 52, 60}, 57, {56, 55, 62}};
static const joint_error elbow = {{60, 65, 68, 74, 80}, 87, {99, 100, 115}};
static const joint_error wrist = {{94, 102, 108, 115, 132}, 172, {178, 187, 213}};
static const joint_error hip = {{40, 43, 48, 50, 61}, 56, {55, 54, 61}};
static const joint_error knee = {{65, 70, 79, 84, 104}, 105, {110, 120, 129}};
static const joint_error ankle = {{95, 103, 117, 128, 152}, 158, {172, 194, 198}};

static const joint_error *const errors[EDML_JOINTS] = {
    &head,  &neck, &shoulder, &elbow, &wrist, &shoulder, &elbow,
    &wrist, &hip,  &knee,     &ankle, &hip,   &knee,     &ankle,
};

edml_status edml_uncertainty(uint8_t millimetres[EDML_JOINTS], uint16_t seen)
{
    if (millimetres == NULL) return EDML_ERR_ARGUMENT;
    int missing = 0;
    for (int j = 0; j < EDML_JOINTS; j++) missing += !(seen >> j & 1);
    if (missing > MOST_MISSING) return EDML_ERR_TOO_FEW_JOINTS;
    uint16_t lonely = 0; /* bit j: a joint at the other end of a bone was not seen */
    for (int n = 0; n < EDML_BONES; n++) {
        const int from = edml_bones[n].from, to = edml_bones[n].to;
        if (!(seen >> from & 1)) lonely = (uint16_t)(lonely | 1U << to);
        if (!(seen >> to & 1)) lonely = (uint16_t)(lonely | 1U << from);
    }
    for (int j = 0; j < EDML_JOINTS; j++) {
        const joint_error *of = errors[j];
        millimetres[j] = seen >> j & 1     ? of->seen[missing]
                         : lonely >> j & 1 ? of->lost[missing - 2]
                                           : of->alone;
    }
    return EDML_OK;
}
