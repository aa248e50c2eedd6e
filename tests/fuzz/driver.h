/* A main of its own for fuzzers: inputs that are pseudo-random, or in files.  With libFuzzer, which has a main,
 * EDML_LIBFUZZER is defined, and driver.c is empty.
 *
 *     PROGRAM                       names the targets
 *     PROGRAM TARGET FILE...        runs inputs that are in files, or in files of folders
 *     PROGRAM TARGET -runs=N        so many pseudo-random inputs, from the one of number -seed=N on; the last of
 *                                   them, whatever ends the program, is in fuzz_TARGET.input
 *     PROGRAM TARGET -seconds=N     as many as in that time
 *     ... -save=FOLDER              writes each of them there
 *     PROGRAM all ...               the same with every target
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_FUZZ_DRIVER_H
#define EDML_FUZZ_DRIVER_H

#include <stddef.h>
#include <stdint.h>

enum { INPUT_BYTES = 1024 };

/* What a fuzzer has. */
extern const char *const fuzz_target_names[]; /* of its targets, ended by NULL */
void fuzz_select(int target);
size_t fuzz_fill(uint8_t input[INPUT_BYTES], uint64_t number); /* its n-th input; returns its length */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Pseudo-random bits, the k-th of number n (splitmix64). */
static inline uint64_t random_bits(uint64_t n, uint64_t k)
{
    uint64_t z = (n * 65536 + k + 1) * 0x9E3779B97F4A7C15U;
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9U;
    z = (z ^ z >> 27) * 0x94D049BB133111EBU;
    return z ^ z >> 31;
}

#endif
