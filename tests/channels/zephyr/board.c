/* What the sample calls of Zephyr, on a Cortex-M board of QEMU's: main() on a stack as large as the main thread's.
 *
 * SPDX-License-Identifier: MIT
 */
#include <zephyr/kernel.h>

#include "measure.h"

static volatile uint8_t *top; /* of that stack */

int zephyr_main(void);

uint32_t k_cycle_get_32(void) { return read_counter(); }

uint32_t k_cyc_to_us_floor32(uint32_t counts) { return counts * 10 / (COUNTS_PER_1000 * MHZ / 100); }

k_tid_t k_current_get(void) { return NULL; }

int k_thread_stack_space_get(const struct k_thread *thread, size_t *unused)
{
    (void)thread;
    *unused = (size_t)untouched_stack(top, STACK);
    return 0;
}

int main(void)
{
    start_counter();
    top = stack_pointer();
    paint_stack(top, STACK);
    return zephyr_main();
}
