/* The fuzzers of the library in one program: driver.h says how to run it.  With libFuzzer the first option is
 * -target=NAME.
 *
 * SPDX-License-Identifier: MIT
 */
#include "fuzz.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "driver.h"
#include "edmlift.h"

#define DECLARE_ONE(name) fuzz_target fuzz_##name;
#define DECLARE_BOTH(name) fuzz_target fuzz_##name, fuzz_##name##_q;
FUZZ_TARGETS_OF_BOTH(DECLARE_BOTH)
FUZZ_TARGETS_OF_ONE(DECLARE_ONE)

#define ONE_NAME(name) #name,
#define BOTH_NAMES(name) #name, #name "_q",
const char *const fuzz_target_names[] = {FUZZ_TARGETS_OF_BOTH(BOTH_NAMES) FUZZ_TARGETS_OF_ONE(ONE_NAME)
                                             NULL};

#define ONE_FUNCTION(name) fuzz_##name,
#define BOTH_FUNCTIONS(name) fuzz_##name, fuzz_##name##_q,
static fuzz_target *const functions[] = {FUZZ_TARGETS_OF_BOTH(BOTH_FUNCTIONS)
                                             FUZZ_TARGETS_OF_ONE(ONE_FUNCTION)};

enum { WATCHED_ONE_IN = 16 };

int fuzz_watches = 1;
static int selected;

void fuzz_select(int target)
{
    selected = target;
    fuzz_watches = 1;
}

size_t fuzz_fill(uint8_t input[INPUT_BYTES], uint64_t number)
{
    fuzz_watches = number % WATCHED_ONE_IN == 0;
    for (uint64_t k = 0; k < INPUT_BYTES / 8; k++) {
        const uint64_t bits = random_bits(number, k);
        memcpy(input + 8 * k, &bits, 8);
    }
    return INPUT_BYTES;
}

/* ---- Choices ------------------------------------------------------------------------------------ */

uint32_t draw_bits(choices *from, int bytes)
{
    uint32_t bits = 0;
    for (int n = 0; n < bytes; n++) {
        if (from->at == from->end) from->behind = from->behind * 1664525U + 1013904223U;
        bits |= (from->at < from->end ? *from->at++ : from->behind >> 24) << 8 * n;
    }
    return bits;
}

uint32_t draw_below(choices *from, uint32_t limit)
{
    return draw_bits(from, limit <= 256 ? 1 : limit <= 65536 ? 2 : 4) % limit;
}

int draw_one_in(choices *from, uint32_t count) { return draw_below(from, count) == count - 1; }

double draw_between(choices *from, double least, double most)
{
    return least + (most - least) * draw_bits(from, 2) / 65535;
}

double draw_magnitude(choices *from, double least, double most)
{
    return least * exp(draw_between(from, 0, log(most / least)));
}

/* ---- Demands ------------------------------------------------------------------------------------ */

void fuzz_fail(const char *what)
{
    fprintf(stderr, "fuzz %s: %s\n", fuzz_target_names[selected], what);
    abort();
}

void take_snapshot(snapshot *of, const void *memory, size_t size)
{
    REQUIRE(size <= sizeof of->copy, "too large for a snapshot");
    of->memory = memory;
    of->size = size;
    memcpy(of->copy, memory, size);
}

int check_status(int status, unsigned allowed, const snapshot *of)
{
    REQUIRE(edml_status_name((edml_status)status)[0] != '?', "an unknown status");
    if (status == EDML_OK) return 1;
    REQUIRE(allowed >> -status & 1, edml_status_name((edml_status)status)); /* without a cause */
    REQUIRE(memcmp(of->memory, of->copy, of->size) == 0, "refused, but something was written");
    return 0;
}

/* ---- Inputs --------------------------------------------------------------------------------------- */

int LLVMFuzzerInitialize(int *argc, char ***argv);

/* Takes -target= out of libFuzzer's arguments. */
int LLVMFuzzerInitialize(int *argc, char ***argv)
{
    const char *name = *argc > 1 && strncmp((*argv)[1], "-target=", 8) == 0 ? (*argv)[1] + 8 : "";
    for (int n = 0; fuzz_target_names[n] != NULL; n++) {
        if (strcmp(fuzz_target_names[n], name) != 0) continue;
        fuzz_select(n);
        memmove(*argv + 1, *argv + 2, (size_t)(*argc - 1) * sizeof **argv);
        --*argc;
        return 0;
    }
    fprintf(stderr, "fuzz: the first option must be -target=NAME, of a target that there is\n");
    exit(2);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    choices from = {data, data + size, 1};
    functions[selected](&from);
    return 0;
}
