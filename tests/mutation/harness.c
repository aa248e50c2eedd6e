/* Runs Unity's tests with one mutant of the library; linked with --wrap=UnityDefaultTestRun.
 *
 *   EDML_MUTANT=N        which one; 0 or nothing: the library as it is
 *   EDML_TESTS=,A:S,B:S, these tests alone, each with the seconds of the processor's time after which the program
 *                        dies, or 0; nothing: all tests
 *   EDML_REACHED=FILE    appends a line for each test: its name, its seconds, the mutants that it reached
 *   EDML_LIST=1          prints the tests' names and runs none
 *
 * Ends at the first test that fails.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

#include "unity.h"

int edml_chosen_mutant;
double edml_mutant_reached[EDML_MUTANTS + 1];

void __real_UnityDefaultTestRun(UnityTestFunction test, const char *name, int line);
void __wrap_UnityDefaultTestRun(UnityTestFunction test, const char *name, int line);

/* Before main(). */
__attribute__((constructor)) static void choose(void)
{
    const char *mutant = getenv("EDML_MUTANT");
    if (mutant != NULL) edml_chosen_mutant = atoi(mutant);
}

/* SIGPROF ends the program then; 0 seconds: never. */
static void limit_time(double seconds)
{
    struct itimerval timer = {{0, 0}, {(time_t)seconds, 0}};
    timer.it_value.tv_usec = (suseconds_t)((seconds - (double)timer.it_value.tv_sec) * 1e6);
    setitimer(ITIMER_PROF, &timer, NULL);
}

/* Also limits the time of a test that is. */
static int is_wanted(const char *name)
{
    const char *tests = getenv("EDML_TESTS");
    char wanted[200];
    if (tests == NULL) return 1;
    snprintf(wanted, sizeof wanted, ",%s:", name);
    const char *found = strstr(tests, wanted);
    if (found == NULL) return 0;
    limit_time(atof(found + strlen(wanted)));
    return 1;
}

static void append_reached(const char *path, const char *name, double seconds)
{
    FILE *file = fopen(path, "a");
    if (file == NULL) _exit(2);
    fprintf(file, "%s %.6f", name, seconds);
    for (int n = 1; n <= EDML_MUTANTS; n++)
        if (edml_mutant_reached[n] > 0) fprintf(file, " %d", n);
    fprintf(file, "\n");
    fclose(file);
}

void __wrap_UnityDefaultTestRun(UnityTestFunction test, const char *name, int line)
{
    const char *path = getenv("EDML_REACHED");
    if (getenv("EDML_LIST") != NULL) printf("LIST %s\n", name);
    if (getenv("EDML_LIST") != NULL || !is_wanted(name)) return;
    const clock_t start = clock();
    memset(edml_mutant_reached, 0, sizeof edml_mutant_reached);
    __real_UnityDefaultTestRun(test, name, line);
    if (path != NULL) append_reached(path, name, (double)(clock() - start) / CLOCKS_PER_SEC);
    fflush(stdout);
    if (Unity.TestFailures > 0) _exit(1);
}
