/* The smallest program that lifts: what it links is what a lift takes of the flash.  With -DPART=stage_angles
 * an optional part follows.
 *
 * SPDX-License-Identifier: MIT
 */
#include "lift.h"

int main(void)
{
    stage_lift();
#ifdef PART
    PART();
#endif
    return out.seen;
}
