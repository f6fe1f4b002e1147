/* Stand-in: the part of ESP-IDF's header that the example uses. */
#pragma once
#include <stdint.h>

int64_t esp_timer_get_time(void);
