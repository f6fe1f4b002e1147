/* Stand-in: the part of ESP-IDF's header that the example uses. */
#pragma once
#include <stdint.h>

typedef struct {
    uint32_t owner;
} portMUX_TYPE;
#define portMUX_INITIALIZER_UNLOCKED {0u}
#ifndef CONFIG_FREERTOS_HZ
#define CONFIG_FREERTOS_HZ 100 /* as without an sdkconfig of one's own */
#endif
#define portTICK_PERIOD_MS (1000u / CONFIG_FREERTOS_HZ)
void portENTER_CRITICAL(portMUX_TYPE *lock);
void portEXIT_CRITICAL(portMUX_TYPE *lock);
