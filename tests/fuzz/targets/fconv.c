/* edml_lift() of any frame by FConv.
 *
 * SPDX-License-Identifier: MIT
 */
#define NAME_OF_THIS fconv
#define DRAW_MODEL(from) FUZZ_FCONV
#include "lift.c"
