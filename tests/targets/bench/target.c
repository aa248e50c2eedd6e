/* Instructions and stack of each stage on an emulated core: the mean and the deepest over the poses.
 * Prints "name instructions stack" a line, with zeros where the model goes without the stage.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>
#include <stdlib.h>

#include "stages.h"

#include "measure.h"

STAGE nothing(void) {}

int main(void)
{
    static uint64_t sum[STAGES];
    static int deepest[STAGES];
    for (int i = 0; i < POSES; i++) {
        make_pose(i);
        /* Counted first: a stage that runs a second time, to look at its stack, may find its work
         * done, as the refinement does. */
        for (int s = 0; s < STAGES; s++) {
            if (!has_stage(s)) continue;
            sum[s] += counts(stages[s].run) - counts(nothing);
            const int stack = stack_bytes(stages[s].run);
            if (stack > deepest[s]) deepest[s] = stack;
        }
    }
    for (int s = 0; s < STAGES; s++)
        printf("%s %lu %d\n", stages[s].name,
               (unsigned long)(sum[s] * 1000 / COUNTS_PER_1000 / POSES), deepest[s]);
    return 0;
}
