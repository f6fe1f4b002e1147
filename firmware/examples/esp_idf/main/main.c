/* Latches the falling edge of a probe on pin 4, in microseconds. The interrupt is that of the core
 * which app_main() runs on, so masking it there suffices. */
#include <stdio.h>

#include "driver/gpio.h"
#include "esp_timer.h"
#include "freertos/FreeRTOS.h"
#include "freertos/task.h"
#include "skiplatch.h"

#define PROBE_PIN  GPIO_NUM_4
#define CONFIRM_US 2500u
#define HOLDOFF_US 10000u
#define POLL_TICKS 1u /* of FreeRTOS */

_Static_assert(POLL_TICKS * portTICK_PERIOD_MS * 1000u < CONFIRM_US,
               "poll more often than confirm_ticks: CONFIG_FREERTOS_HZ=1000, as in sdkconfig.defaults");

static skip_input_t input;
static portMUX_TYPE lock = portMUX_INITIALIZER_UNLOCKED;

static void on_edge(void *unused) { (void)unused; skip_input_on_edge(&input, (uint32_t)esp_timer_get_time()); }
int hal_edge_arm(const hal_edge_config_t *config)
{
    (void)config;
    gpio_config(&(gpio_config_t){.pin_bit_mask = 1ull << PROBE_PIN, .mode = GPIO_MODE_INPUT,
                                 .pull_up_en = GPIO_PULLUP_ENABLE, .intr_type = GPIO_INTR_NEGEDGE});
    gpio_install_isr_service(0);
    return gpio_isr_handler_add(PROBE_PIN, on_edge, NULL) == ESP_OK ? HAL_OK : HAL_ERR_CONFIG;
}
void hal_edge_disarm(uint8_t channel) { (void)channel; gpio_isr_handler_remove(PROBE_PIN); }
bool hal_edge_level(uint8_t channel) { (void)channel; return gpio_get_level(PROBE_PIN) == 0; }
int32_t hal_axis_position_counts(uint8_t axis) { (void)axis; return 0; } /* your step counter */
hal_critical_state_t hal_critical_enter(void) { portENTER_CRITICAL(&lock); return 0u; }
void hal_critical_exit(hal_critical_state_t saved) { (void)saved; portEXIT_CRITICAL(&lock); }

void app_main(void)
{
    latch_record_t record;
    skip_input_start(&input, &(skip_input_config_t){.axis = 0u});
    latch_arm(&input.latch, &(latch_config_t){.repeated = true, .confirm_ticks = CONFIRM_US, .holdoff_ticks = HOLDOFF_US});
    for (;;) {
        skip_input_poll(&input, (uint32_t)esp_timer_get_time());
        if (latch_take(&input.latch, &record)) {
            printf("%lu\n", (unsigned long)record.ticks);
        }
        vTaskDelay(POLL_TICKS);
    }
}
