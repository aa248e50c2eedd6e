/* The smallest program that lifts: what it links is what a lift takes of the flash.
 *
 * SPDX-License-Identifier: MIT
 */
#include "lift.h"

int main(void)
{
    stage_lift();
    return out.seen;
}
