/* What gen/joint_limits.h fills in.  Not part of the public interface.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_LIMITS_H
#define EDML_LIMITS_H

#include "edmlift.h"

/* Raised when the meaning of the generated data changes; a header of another format does not
 * compile. */
#define EDML_LIMITS_FORMAT 1

/* A map has a bit for each cell of directions, octahedral: where a bone points in people.  Forearms and
 * shins have a map for each cell, of twice the size, of the bone that they hang on. */
enum {
    EDML_LIMIT_CELLS = 16, /* rows of a map, and columns, from bit 0 on */
    EDML_LIMIT_PARENTS = 8,
    /* Of each kind, the first map. */
    EDML_LIMIT_ARMS = 0,
    EDML_LIMIT_FOREARMS = 1,
    EDML_LIMIT_HEAD = EDML_LIMIT_FOREARMS + EDML_LIMIT_PARENTS * EDML_LIMIT_PARENTS,
    EDML_LIMIT_THIGHS,
    EDML_LIMIT_SHINS,
    EDML_LIMIT_MAPS = EDML_LIMIT_SHINS + EDML_LIMIT_PARENTS * EDML_LIMIT_PARENTS
};

extern const uint16_t edml__limits[EDML_LIMIT_MAPS][EDML_LIMIT_CELLS];

#endif
