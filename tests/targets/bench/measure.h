/* Instructions and stack of a function, on an emulated core.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef MEASURE_H
#define MEASURE_H

#include "counter.h"

enum { PAINT_BYTES = 3072, PAINT = 0xA5 };

static inline uint32_t counts(void (*run)(void))
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

#endif
