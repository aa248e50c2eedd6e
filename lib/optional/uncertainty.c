/* How far off joints are, given which were seen.  Means over training people with an imitated
 * detector's noise: tools/fitting/body.py.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stddef.h>

#include "edmlift/body.h"

enum { MOST_MISSING = 4 };

typedef struct {
    uint8_t seen[MOST_MISSING + 1]; /* millimetres, by how many joints were not seen */
    uint8_t alone;                  /* not seen, while all its neighbours were */
    uint8_t lost[MOST_MISSING - 1]; /* not seen, nor a neighbour, by how many joints were not seen: from 2 on */
} joint_error;

static const joint_error head = {{54, 56, 61, 60, 73}, 71, {70, 74, 76}};
static const joint_error neck = {{31, 32, 36, 36, 46}, 36, {36, 36, 38}};
static const joint_error shoulder = {{40, 42, 46, 46, 57}, 50, {49, 51, 55}};
static const joint_error elbow = {{57, 60, 64, 65, 74}, 80, {93, 89, 107}};
static const joint_error wrist = {{88, 92, 99, 100, 114}, 145, {173, 183, 207}};
static const joint_error hip = {{39, 41, 46, 45, 59}, 50, {47, 47, 54}};
static const joint_error knee = {{62, 65, 73, 72, 90}, 94, {110, 105, 124}};
static const joint_error ankle = {{91, 96, 108, 106, 129}, 143, {172, 184, 187}};

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
