/* What the example calls of ESP-IDF, on a RISC-V board of QEMU's: app_main() on a stack as large as the main
 * task's, until it waits.
 *
 * SPDX-License-Identifier: MIT
 */
#include "esp_timer.h"
#include "freertos/task.h"

#include "measure.h"

static volatile uint8_t *top; /* of that stack */

void app_main(void);

int64_t esp_timer_get_time(void) { return read_counter() * 10 / (COUNTS_PER_1000 * MHZ / 100); }

UBaseType_t uxTaskGetStackHighWaterMark(TaskHandle_t task)
{
    (void)task;
    return (UBaseType_t)untouched_stack(top, STACK);
}

void vTaskDelay(TickType_t ticks)
{
    (void)ticks;
    exit(0);
}

int main(void)
{
    start_counter();
    top = stack_pointer();
    paint_stack(top, STACK);
    app_main();
    return 1; /* it never returns */
}
