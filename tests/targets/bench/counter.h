/* Counts instructions under `qemu -icount`: COUNTS_PER_1000 in 1000 instructions.  With -DRP2040, cycles of
 * the model of tools/reports/rp2040.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#ifdef __riscv

static uint32_t instret(void)
{
    uint32_t count;
    __asm__ volatile(".option push\n.option arch, +zicsr\ncsrr %0, minstret\n.option pop"
                     : "=r"(count));
    return count;
}

static uint32_t counter_start;

static void start_counter(void) { counter_start = instret(); }
static uint32_t read_counter(void) { return instret() - counter_start; }

#elif defined(RP2040) /* BKPT 1 */

static uint32_t cycles(void)
{
    register uint32_t now __asm__("r0");
    __asm__ volatile("bkpt 1" : "=r"(now)::"memory");
    return now;
}

static uint32_t counter_start;

static void start_counter(void) { counter_start = cycles(); }
static uint32_t read_counter(void) { return cycles() - counter_start; }

#else /* Cortex-M: SysTick counts time down, and an instruction takes always the same time */

#define SYST_CSR (*(volatile uint32_t *)0xE000E010U)
#define SYST_RVR (*(volatile uint32_t *)0xE000E014U)
#define SYST_CVR (*(volatile uint32_t *)0xE000E018U)

enum { SYSTICK_RUNS = 5, SYSTICK_PASSED_ZERO = 1 << 16, SYSTICK_MOST = 0xFFFFFF };

static void start_counter(void)
{
    SYST_RVR = SYSTICK_MOST;
    SYST_CVR = 0; /* the next tick loads SYSTICK_MOST */
    SYST_CSR = SYSTICK_RUNS;
    while (SYST_CVR == 0) continue;
}

static uint32_t read_counter(void)
{
    const uint32_t now = SYST_CVR;
    if (SYST_CSR & SYSTICK_PASSED_ZERO) {
        puts("too long for SysTick");
        exit(1);
    }
    return SYSTICK_MOST - now;
}

#endif

static volatile uint8_t *stack_pointer(void)
{
    volatile uint8_t *top;
#ifdef __riscv
    __asm__ volatile("mv %0, sp" : "=r"(top));
#else
    __asm__ volatile("mov %0, sp" : "=r"(top));
#endif
    return top;
}
