/* Masks of the joints that were seen: bit j is joint j.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_SEEN_H
#define EDML_SEEN_H

#include "../api/api.h"

#define ALL_JOINTS ((uint16_t)((1U << EDML_JOINTS) - 1))

static inline int is_seen(uint16_t seen, int j) { return seen >> j & 1; }

static inline uint16_t seen_joints(const edml_keypoint in[])
{
    unsigned seen = 0;
    for (int j = 0; j < EDML_JOINTS; j++)
        if (in[j].c > 0) seen |= 1U << j;
    return (uint16_t)seen;
}

/* Bits beyond the joints do not count. */
static inline int count_seen(uint16_t seen)
{
    int count = 0;
    for (seen = (uint16_t)(seen & ALL_JOINTS); seen != 0; seen = (uint16_t)(seen & (seen - 1))) {
        ASSUME(count < EDML_JOINTS); /* each turn takes a bit out */
        count++;
    }
    return count;
}

/* Are all confidences numbers, and the coordinates of the seen joints? */
static inline int are_finite(const edml_keypoint in[], uint16_t seen)
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (!IS_FINITE(in[j].c)) return 0;
        if (is_seen(seen, j) && !(IS_FINITE(in[j].x) && IS_FINITE(in[j].y))) return 0;
    }
    return 1;
}

#endif
