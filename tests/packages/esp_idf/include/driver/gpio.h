/* Stand-in: the part of ESP-IDF's header that the example uses. */
#pragma once
#include <stdint.h>

typedef int esp_err_t;
typedef enum { GPIO_NUM_4 = 4 } gpio_num_t;
typedef struct {
    uint64_t pin_bit_mask;
    int      mode;
    int      pull_up_en;
    int      pull_down_en;
    int      intr_type;
} gpio_config_t;
enum { GPIO_MODE_INPUT = 1, GPIO_PULLUP_ENABLE = 1, GPIO_INTR_NEGEDGE = 2, ESP_OK = 0 };

esp_err_t gpio_config(const gpio_config_t *config);
esp_err_t gpio_install_isr_service(int flags);
esp_err_t gpio_isr_handler_add(gpio_num_t pin, void (*handler)(void *), void *argument);
esp_err_t gpio_isr_handler_remove(gpio_num_t pin);
int       gpio_get_level(gpio_num_t pin);
