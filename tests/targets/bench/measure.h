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

/* Paints so many bytes of stack below `top`, the stack pointer: in line, because a call's frame lies there. */
static inline __attribute__((always_inline)) void paint_stack(volatile uint8_t *top, int bytes)
{
    for (int n = 1; n <= bytes; n++) top[-n] = PAINT;
}

/* How many of these bytes still have their paint, from the far end on. */
static inline int untouched_stack(const volatile uint8_t *top, int bytes)
{
    int untouched = 0;
    while (untouched < bytes && top[untouched - bytes] == PAINT) untouched++;
    return untouched;
}

/* Paints the memory below the stack pointer, runs, and looks how far the paint is gone. */
static __attribute__((noinline)) int stack_bytes(void (*run)(void))
{
    volatile uint8_t *const top = stack_pointer();
    paint_stack(top, PAINT_BYTES);
    run();
    return PAINT_BYTES - untouched_stack(top, PAINT_BYTES);
}

#endif
