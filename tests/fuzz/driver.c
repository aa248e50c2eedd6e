/* A main of its own for fuzzers.
 *
 * SPDX-License-Identifier: MIT
 */
#define _DEFAULT_SOURCE /* mmap(), scandir() */
#include "driver.h"

#ifndef EDML_LIBFUZZER

#include <dirent.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

typedef unsigned long long number;

static int fail(const char *what)
{
    perror(what);
    return 2;
}

/* ---- Files ---------------------------------------------------------------------------------------- */

static int run_file(const char *name)
{
    static uint8_t data[1 << 20];
    FILE *file = fopen(name, "rb");
    if (file == NULL) return fail(name);
    const size_t size = fread(data, 1, sizeof data, file);
    fclose(file);
    return LLVMFuzzerTestOneInput(data, size);
}

static int run_folder(const char *name)
{
    struct dirent **entries;
    const int count = scandir(name, &entries, NULL, alphasort);
    int status = 0;
    if (count < 0) return run_file(name);
    for (int n = 0; n < count; n++) {
        char path[4096];
        snprintf(path, sizeof path, "%s/%s", name, entries[n]->d_name);
        if (entries[n]->d_name[0] != '.') status |= run_file(path);
        free(entries[n]);
    }
    free(entries);
    return status;
}

/* ---- Pseudo-random inputs --------------------------------------------------------------------------- */

enum { NAME_BYTES = 64 };

static void name_input(char name[NAME_BYTES], const char *target)
{
    snprintf(name, NAME_BYTES, "fuzz_%s.input", target);
}

/* Memory that is a file: whatever ends the program, the last input is there. */
static uint8_t *open_input(int *file, const char *target)
{
    char name[NAME_BYTES];
    name_input(name, target);
    *file = open(name, O_RDWR | O_CREAT, 0666);
    void *memory = MAP_FAILED;
    if (*file >= 0 && ftruncate(*file, INPUT_BYTES) == 0)
        memory = mmap(NULL, INPUT_BYTES, PROT_READ | PROT_WRITE, MAP_SHARED, *file, 0);
    if (memory == MAP_FAILED) exit(fail(name));
    return memory;
}

/* Nothing was found: the file goes. */
static void close_input(int file, uint8_t *memory, const char *target)
{
    char name[NAME_BYTES];
    name_input(name, target);
    munmap(memory, INPUT_BYTES);
    close(file);
    remove(name);
}

static void save(const char *folder, number n, const uint8_t *input, size_t size)
{
    char name[4096];
    snprintf(name, sizeof name, "%s/%llu", folder, n);
    FILE *file = fopen(name, "wb");
    if (file == NULL || fwrite(input, 1, size, file) != size || fclose(file) != 0) exit(fail(name));
}

static double seconds_now(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

typedef struct {
    number runs, seconds, seed; /* runs and seconds 0: none */
    const char *folder;         /* where inputs are saved, or NULL */
} plan;

static void run_random(int target, const plan *by)
{
    int file;
    uint8_t *const input = open_input(&file, fuzz_target_names[target]);
    size_t length = INPUT_BYTES;
    const double end = seconds_now() + (double)by->seconds;
    number n = 0;
    fuzz_select(target);
    for (; by->runs == 0 || n < by->runs; n++) {
        if (by->seconds > 0 && n % 16 == 0 && seconds_now() >= end) break;
        const size_t size = fuzz_fill(input, by->seed + n);
        if (size != length && ftruncate(file, (off_t)size) != 0) exit(fail("input"));
        length = size;
        if (by->folder != NULL) save(by->folder, by->seed + n, input, size);
        LLVMFuzzerTestOneInput(input, size);
    }
    close_input(file, input, fuzz_target_names[target]);
    printf("%s: %llu inputs\n", fuzz_target_names[target], n);
    fflush(stdout);
}

/* ---- Arguments -------------------------------------------------------------------------------------- */

static int name_targets(void)
{
    for (int n = 0; fuzz_target_names[n] != NULL; n++) puts(fuzz_target_names[n]);
    return 0;
}

/* Takes an option; returns 0 for what is none. */
static int take_option(plan *by, const char *argument)
{
    if (strncmp(argument, "-save=", 6) == 0) by->folder = argument + 6;
    return by->folder == argument + 6 || sscanf(argument, "-runs=%llu", &by->runs) == 1 ||
           sscanf(argument, "-seed=%llu", &by->seed) == 1 ||
           sscanf(argument, "-seconds=%llu", &by->seconds) == 1;
}

int main(int argc, char **argv)
{
    plan by = {0, 0, 0, NULL};
    int known = 0, status = 0;
    if (argc < 2) return name_targets();
    for (int target = 0; fuzz_target_names[target] != NULL; target++) {
        if (strcmp(argv[1], "all") != 0 && strcmp(argv[1], fuzz_target_names[target]) != 0) continue;
        known = 1;
        fuzz_select(target);
        for (int n = 2; n < argc; n++)
            if (!take_option(&by, argv[n])) status |= run_folder(argv[n]);
        if (by.runs > 0 || by.seconds > 0) run_random(target, &by);
    }
    if (!known) fprintf(stderr, "%s: no target %s; without arguments it names them\n", argv[0], argv[1]);
    return known ? status : 2;
}

#else
typedef int not_empty;
#endif
