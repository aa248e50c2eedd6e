/* What gen/joint_limits.h fills in.  Not part of the public interface.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_JOINT_LIMIT_MAPS_H
#define EDML_JOINT_LIMIT_MAPS_H

#include <stdint.h>

#include "../number/compiler.h"

/* Raised when the meaning of the generated data changes; a header of another format does not
 * compile. */
#define EDML_JOINT_LIMITS_FORMAT 1

/* A map has a bit for each cell of directions on an octahedron: set where people's bones point.  Forearms and
 * shins have several maps, one for each cell (of twice the size) of the bone that they hang on. */
enum {
    EDML_MAP_CELLS = 16, /* rows of a map, and columns, from bit 0 on */
    EDML_MAP_PARENTS = 8,
    /* The first map of each kind. */
    EDML_ARM_MAPS = 0,
    EDML_FOREARM_MAPS = 1,
    EDML_HEAD_MAPS = EDML_FOREARM_MAPS + EDML_MAP_PARENTS * EDML_MAP_PARENTS,
    EDML_THIGH_MAPS,
    EDML_SHIN_MAPS,
    EDML_MAPS = EDML_SHIN_MAPS + EDML_MAP_PARENTS * EDML_MAP_PARENTS
};

EDML_INTERNAL extern const uint16_t edml__joint_limit_maps[EDML_MAPS][EDML_MAP_CELLS];

#endif
