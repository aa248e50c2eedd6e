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

static const joint_error head = {{57, 62, 65, 73, 83}, 78, {78, 85, 88}};
static const joint_error neck = {{31, 34, 37, 41, 50}, 37, {35, 42, 44}};
static const joint_error shoulder = {{41, 45, 47, 53, 62}, 55, {52, 54, 58}};
static const joint_error elbow = {{59, 64, 66, 76, 88}, 83, {92, 97, 112}};
static const joint_error wrist = {{90, 99, 106, 117, 148}, 165, {168, 188, 210}};
static const joint_error hip = {{38, 42, 46, 51, 64}, 54, {49, 52, 59}};
static const joint_error knee = {{64, 70, 78, 87, 109}, 102, {102, 117, 141}};
static const joint_error ankle = {{94, 104, 116, 129, 163}, 156, {161, 188, 209}};

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
