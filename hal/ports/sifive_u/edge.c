/* The trigger line: pin 4 with its edge interrupts. */
#include "hal_edge.h"

#include "drivers.h"
#include "fu540.h"
#include "hal_clock.h"
#include "hal_edge_events.h"
#include "hal_error.h"

#define CHANNEL 0u
#define PIN     4u
#define LINE    (1u << PIN)

static volatile bool edge_active_low;

/* An edge that has got as far as the interrupt controller finds no request of the pin any more. */
static void stop_watching(void)
{
    GPIO_RISE_IE &= ~LINE;
    GPIO_FALL_IE &= ~LINE;
    GPIO_RISE_IP = LINE;
    GPIO_FALL_IP = LINE;
}

void edge_start(void)
{
    edge_active_low = false;
    GPIO_INPUT_EN |= LINE;
    stop_watching();
    riscv_enable_irq(IRQ_GPIO(PIN), PRIORITY_EDGE);
}

bool edge_pin_is_high(void)
{
    return (GPIO_VALUE & LINE) != 0u;
}

int hal_edge_arm(const hal_edge_config_t *config)
{
    if (config->channel != CHANNEL) {
        return HAL_ERR_CHANNEL;
    }
    if (config->glitch_filter_us != 0u) {
        return HAL_ERR_CONFIG; /* the pin has none */
    }
    stop_watching();
    edge_active_low = config->active_low;
    if (config->active_low) {
        GPIO_FALL_IE |= LINE;
    } else {
        GPIO_RISE_IE |= LINE;
    }
    return HAL_OK;
}

void hal_edge_disarm(uint8_t channel)
{
    if (channel == CHANNEL) {
        stop_watching();
    }
}

bool hal_edge_level(uint8_t channel)
{
    return channel == CHANNEL && edge_pin_is_high() != edge_active_low;
}

/* The clock before anything else. */
void edge_interrupt(void)
{
    uint32_t captured_ticks = hal_clock_now_ticks();

    if ((((GPIO_RISE_IP & GPIO_RISE_IE) | (GPIO_FALL_IP & GPIO_FALL_IE)) & LINE) != 0u) {
        GPIO_RISE_IP = LINE;
        GPIO_FALL_IP = LINE;
        hal_edge_on_latch(CHANNEL, captured_ticks);
    }
}
