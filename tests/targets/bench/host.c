/* Lifts a second on one core, of a stream of people who differ: a processor learns the branches of those who
 * come again.  `bench_... COUNT` runs every stage on COUNT poses instead, for callgrind.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "stages.h"

enum { PEOPLE = 20000, ROUNDS = 7 };

static edml_keypoint people[PEOPLE][EDML_JOINTS];

static double lifts_a_second(void)
{
    const clock_t start = clock();
    for (int n = 0; n < PEOPLE; n++) edml_lift(&out, people[n], NULL, &MODEL, &work, sizeof work);
    return PEOPLE / ((double)(clock() - start) / CLOCKS_PER_SEC);
}

int main(int argc, char **argv)
{
    const long count = argc > 1 ? strtol(argv[1], NULL, 10) : 0;
    for (long n = 0; n < count; n++) {
        make_pose((int)(n % POSES));
        for (int s = 0; s < STAGES; s++)
            if (has_stage(s)) stages[s].run();
    }
    if (count > 0) return 0;

    for (int n = 0; n < PEOPLE; n++) {
        make_pose(n);
        memcpy(people[n], in, sizeof in);
    }
    double best = 0;
    for (int round = 0; round < ROUNDS; round++) {
        const double rate = lifts_a_second();
        if (rate > best) best = rate;
    }
    printf("%.0f lifts a second on one core (best of %d rounds)\n", best, ROUNDS);
    return 0;
}
