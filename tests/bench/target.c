/* Instructions and stack of each stage on an emulated Cortex-M: mean over the poses, by SysTick
 * under `qemu -icount shift=7`, and the deepest stack, by painting.  Prints "name instructions
 * stack" a line.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>

#include "stages.h"

#define SYST_CSR (*(volatile uint32_t *)0xE000E010U)
#define SYST_RVR (*(volatile uint32_t *)0xE000E014U)
#define SYST_CVR (*(volatile uint32_t *)0xE000E018U)

/* With shift=7 an instruction takes 128 ns; the board's SysTick runs at TICK_MHZ. */
#ifndef TICK_MHZ
#define TICK_MHZ 25
#endif

enum { PAINT_BYTES = 3072, PAINT = 0xA5 };

STAGE nothing(int i) { (void)i; }

static uint32_t ticks(void (*run)(int), int i)
{
    const uint32_t start = SYST_CVR;
    run(i);
    return (start - SYST_CVR) & 0xFFFFFFU;
}

static uint32_t instructions(void (*run)(int))
{
    uint64_t sum = 0;
    for (int i = 0; i < POSES; i++) sum += ticks(run, i) - ticks(nothing, i);
    return (uint32_t)(sum * 1000 / ((uint64_t)TICK_MHZ * 128) / POSES);
}

/* Paints the memory below the stack pointer, runs, and looks how far the paint is gone. */
static __attribute__((noinline)) uint32_t stack_bytes(void (*run)(int))
{
    volatile uint8_t *top;
    __asm__ volatile("mov %0, sp" : "=r"(top));
    for (int n = 1; n <= PAINT_BYTES; n++) top[-n] = PAINT;
    run(0);
    int untouched = PAINT_BYTES;
    while (untouched > 0 && top[-untouched] == PAINT) untouched--;
    return (uint32_t)untouched;
}

int main(void)
{
    make_poses();
    SYST_RVR = 0xFFFFFFU;
    SYST_CVR = 0;
    SYST_CSR = 5;
    for (int s = 0; s < STAGES; s++) {
        /* The refinement starts from the points of the MDS, not from those that orient left. */
        if (s > 0) stage_mds(0);
        printf("%s %lu %lu\n", stages[s].name, (unsigned long)instructions(stages[s].run),
               (unsigned long)stack_bytes(stages[s].run));
    }
    return 0;
}
