/* Latches the edge of the probe that the devicetree's alias `probe` names, in cycles of the kernel. */
#include <zephyr/drivers/gpio.h>
#include <zephyr/kernel.h>

#include "skiplatch.h"

#define CONFIRM_US 2500u
#define HOLDOFF_US 10000u
#define POLL_MS    1u

/* A sleep is rounded up to ticks of the kernel, and begins within one. */
BUILD_ASSERT(POLL_MS * 1000u + 2u * (1000000u / CONFIG_SYS_CLOCK_TICKS_PER_SEC) < CONFIRM_US,
             "poll more often than confirm_ticks: CONFIG_SYS_CLOCK_TICKS_PER_SEC=10000, as in prj.conf");

static const struct gpio_dt_spec probe = GPIO_DT_SPEC_GET(DT_ALIAS(probe), gpios);
static struct gpio_callback callback;
static skip_input_t input;

static void on_edge(const struct device *port, struct gpio_callback *cb, uint32_t pins)
{
    ARG_UNUSED(port), ARG_UNUSED(cb), ARG_UNUSED(pins);
    skip_input_on_edge(&input, k_cycle_get_32());
}
int hal_edge_arm(const hal_edge_config_t *config)
{
    ARG_UNUSED(config);
    gpio_pin_configure_dt(&probe, GPIO_INPUT);
    gpio_init_callback(&callback, on_edge, BIT(probe.pin));
    gpio_add_callback(probe.port, &callback);
    return gpio_pin_interrupt_configure_dt(&probe, GPIO_INT_EDGE_TO_ACTIVE) == 0 ? HAL_OK : HAL_ERR_CONFIG;
}
void hal_edge_disarm(uint8_t channel) { ARG_UNUSED(channel); gpio_pin_interrupt_configure_dt(&probe, GPIO_INT_DISABLE); }
bool hal_edge_level(uint8_t channel) { ARG_UNUSED(channel); return gpio_pin_get_dt(&probe) > 0; }
int32_t hal_axis_position_counts(uint8_t axis) { ARG_UNUSED(axis); return 0; } /* your step counter */
hal_critical_state_t hal_critical_enter(void) { return irq_lock(); }
void hal_critical_exit(hal_critical_state_t saved) { irq_unlock(saved); }

int main(void)
{
    latch_record_t record;
    skip_input_start(&input, &(skip_input_config_t){.axis = 0u});
    latch_arm(&input.latch, &(latch_config_t){.repeated = true, .confirm_ticks = k_us_to_cyc_ceil32(CONFIRM_US),
                                              .holdoff_ticks = k_us_to_cyc_ceil32(HOLDOFF_US)});
    for (;; k_msleep(POLL_MS)) {
        skip_input_poll(&input, k_cycle_get_32());
        if (latch_take(&input.latch, &record)) {
            printk("%u\n", record.ticks);
        }
    }
}
