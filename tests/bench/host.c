/* Lifts a second on one core.  `bench COUNT` runs every stage COUNT times instead, for callgrind.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "stages.h"

int main(int argc, char **argv)
{
    const long count = argc > 1 ? strtol(argv[1], NULL, 10) : 0;
    make_poses();
    for (long n = 0; n < count; n++)
        for (int s = 0; s < STAGES; s++) stages[s].run((int)(n % POSES));
    if (count > 0) return 0;

    enum { LIFTS = 100000, ROUNDS = 7 };
    double best = 0;
    for (int round = 0; round < ROUNDS; round++) {
        const clock_t start = clock();
        for (int n = 0; n < LIFTS; n++) stage_lift(n % POSES);
        const double rate = LIFTS / ((double)(clock() - start) / CLOCKS_PER_SEC);
        if (rate > best) best = rate;
    }
    printf("%.0f lifts a second on one core (best of %d rounds)\n", best, ROUNDS);
    return 0;
}
