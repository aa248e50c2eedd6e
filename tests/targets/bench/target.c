/* Instructions and stack of each stage on an emulated core: the mean and the deepest over the poses.
 * Prints "name instructions stack" a line, with zeros where the model goes without the stage.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>
#include <stdlib.h>

#include "counter.h"
#include "stages.h"

enum { PAINT_BYTES = 3072, PAINT = 0xA5 };

STAGE nothing(void) {}

static uint32_t counts(void (*run)(void))
{
    start_counter();
    run();
    return read_counter();
}

/* Paints the memory below the stack pointer, runs, and looks how far the paint is gone. */
static __attribute__((noinline)) int stack_bytes(void (*run)(void))
{
    volatile uint8_t *const top = stack_pointer();
    for (int n = 1; n <= PAINT_BYTES; n++) top[-n] = PAINT;
    run();
    int untouched = PAINT_BYTES;
    while (untouched > 0 && top[-untouched] == PAINT) untouched--;
    return untouched;
}

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
