/* Stands for FreeRTOS's.  SPDX-License-Identifier: MIT */
#ifndef FREERTOS_TASK_H
#define FREERTOS_TASK_H

#include <stddef.h>

#include "freertos/FreeRTOS.h"

typedef struct task *TaskHandle_t;

UBaseType_t uxTaskGetStackHighWaterMark(TaskHandle_t task);
void vTaskDelay(TickType_t ticks);

#endif
