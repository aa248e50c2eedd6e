/* Lifts a second on one core.  `bench_... COUNT` runs every stage on COUNT poses instead, for
 * callgrind.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "stages.h"

static double lifts_a_second(int lifts)
{
    const clock_t start = clock();
    for (int n = 0; n < lifts; n++) stage_lift();
    return lifts / ((double)(clock() - start) / CLOCKS_PER_SEC);
}

int main(int argc, char **argv)
{
    enum { LIFTS = 2000, ROUNDS = 7 };
    const long count = argc > 1 ? strtol(argv[1], NULL, 10) : 0;
    for (long n = 0; n < count; n++) {
        make_pose((int)(n % POSES));
        for (int s = 0; s < STAGES; s++)
            if (has_stage(s)) stages[s].run();
    }
    if (count > 0) return 0;

    double best = 0;
    for (int round = 0; round < ROUNDS; round++) {
        double seconds = 0;
        for (int i = 0; i < POSES; i++) {
            make_pose(i);
            seconds += 1 / lifts_a_second(LIFTS);
        }
        if (POSES / seconds > best) best = POSES / seconds;
    }
    printf("%.0f lifts a second on one core (best of %d rounds)\n", best, ROUNDS);
    return 0;
}
