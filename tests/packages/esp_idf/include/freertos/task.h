/* Stand-in: the part of ESP-IDF's header that the example uses. */
#pragma once
#include <stdint.h>

void vTaskDelay(uint32_t ticks);
