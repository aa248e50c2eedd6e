/* Sets of seen joints that the default models take: at most four are missing.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_SETS_H
#define EDML_SETS_H

#include "proof.h"

#include "geometry/seen.h"

enum { FEWEST = 10, ROOM = (1 << 29) - 1 };
#ifndef MOST_MISSING
#define MOST_MISSING 4
#endif

/* A joint as a set; none: -1. */
static inline uint16_t only(int joint) { return joint < 0 ? 0 : (uint16_t)(1U << joint); }

/* Keypoints: anything where they are not seen. */
static inline int32_t some_pixels(int is_seen)
{
    return is_seen ? Frama_C_interval(-ROOM, ROOM) : Frama_C_interval(INT32_MIN, INT32_MAX);
}

static inline int16_t some_confidence(int is_seen)
{
    return (int16_t)(is_seen ? Frama_C_interval(1, INT16_MAX) : Frama_C_interval(INT16_MIN, 0));
}

/* One set of each size.  They stand for all where each joint is treated as the others are. */
static inline void for_sizes(void (*of)(uint16_t seen), int fewest)
{
    for (int missing = 0; missing <= EDML_JOINTS - fewest; missing++)
        of((uint16_t)(ALL_JOINTS & ~((1U << missing) - 1)));
}

/* All.  Missing are a > b > c > d, or none in the place of the last ones. */
static inline void for_sets(void (*of)(uint16_t seen))
{
    /*@ loop unroll 15; */
    for (int a = -1; a < EDML_JOINTS; a++)
        /*@ loop unroll 15; */
        for (int b = -1; b < a || b < 0; b++)
            /*@ loop unroll 15; */
            for (int c = -1; c < b || c < 0; c++)
                /*@ loop unroll 15; */
                for (int d = -1; d < c || d < 0; d++)
                    if ((a >= 0) + (b >= 0) + (c >= 0) + (d >= 0) <= MOST_MISSING)
                        of((uint16_t)(ALL_JOINTS & ~(only(a) | only(b) | only(c) | only(d))));
}

#endif
