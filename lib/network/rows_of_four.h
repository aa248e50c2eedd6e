/* What rows_dsp.h and rows_mve.h share: they sum four rows at a time, the upper or the lower half of a block.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_ROWS_OF_FOUR_H
#define EDML_ROWS_OF_FOUR_H

#include "rows_all_inputs.h"

enum { ROWS = EDML_ROWS / 2 };
#define WEIGHTS_OF(layer, row)                                                                             \
    ((layer)->weight + ((row) & -EDML_ROWS) * (layer)->inputs + ((row) & (EDML_ROWS - 1)) * EDML_CHUNK)

/* From a block to the next, past the half that is not summed: as text, of assembly. */
#ifdef EDML_BYTES
#define OTHER_HALF "32"
#else
#define OTHER_HALF "64"
#endif

#endif
