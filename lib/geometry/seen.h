/* Which joints were seen, and whether they are numbers.
 *
 * SPDX-License-Identifier: MIT
 */

#define ALL_JOINTS ((uint16_t)((1U << EDML_JOINTS) - 1))

/* Bit j: joint j was seen. */
static uint16_t seen_joints(const keypoint in[])
{
    uint16_t seen = 0;
    for (int j = 0; j < EDML_JOINTS; j++)
        if (in[j].c > 0) seen = (uint16_t)(seen | 1U << j);
    return seen;
}

static inline int count_bits(uint16_t mask)
{
    int count = 0;
    for (; mask != 0; mask = (uint16_t)(mask & (mask - 1))) count++;
    return count;
}

static inline int all_finite(const keypoint in[], uint16_t seen)
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (!FINITE(in[j].c)) return 0;
        if ((seen >> j & 1) && !(FINITE(in[j].x) && FINITE(in[j].y))) return 0;
    }
    return 1;
}
