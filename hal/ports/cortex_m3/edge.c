/* The trigger line: pin C4 with its edge interrupt. */
#include "hal_edge.h"

#include "disturbance.h"
#include "drivers.h"
#include "hal_clock.h"
#include "hal_edge_events.h"
#include "hal_error.h"
#include "lm3s6965.h"

#define CHANNEL 0u
#define PIN     (1u << 4)

static volatile bool edge_armed;
static volatile bool edge_active_low;

void edge_start(void)
{
    edge_armed = false;
    edge_active_low = false;
    GPIO_IM(GPIO_C) = 0u;
    GPIO_DIR(GPIO_C) &= ~PIN;
    GPIO_DEN(GPIO_C) |= PIN;
    GPIO_IS(GPIO_C) = 0u; /* edges */
    GPIO_IBE(GPIO_C) = 0u;
    GPIO_ICR(GPIO_C) = PIN;
    cortex_m_enable_irq(IRQ_GPIO_C, PRIORITY_EDGE);
}

bool edge_pin_is_high(void)
{
    return GPIO_DATA(GPIO_C, PIN) != 0u;
}

/* An edge that has got as far as the pin's register or the interrupt controller is dropped. */
static void stop_watching(void)
{
    GPIO_IM(GPIO_C) = 0u;
    edge_armed = false;
    GPIO_ICR(GPIO_C) = PIN;
    NVIC_ICPR(IRQ_GPIO_C) = NVIC_BIT(IRQ_GPIO_C);
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
    GPIO_IEV(GPIO_C) = config->active_low ? 0u : PIN;
    GPIO_ICR(GPIO_C) = PIN; /* the change of polarity may look like an edge */
    edge_armed = true;
    GPIO_IM(GPIO_C) = DISTURBANCE_FILTER_SAMPLES == 0u ? PIN : 0u;
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
    return channel == CHANNEL && disturbance_filtered(edge_pin_is_high()) != edge_active_low;
}

/* The clock before anything else. */
void edge_interrupt(void)
{
    uint32_t captured_ticks = hal_clock_now_ticks();

    if ((GPIO_MIS(GPIO_C) & PIN) != 0u) {
        GPIO_ICR(GPIO_C) = PIN;
        hal_edge_on_latch(CHANNEL, captured_ticks);
    }
}

void edge_on_filtered(bool is_high)
{
    if (edge_armed && is_high != edge_active_low) {
        hal_edge_on_latch(CHANNEL, hal_clock_now_ticks());
    }
}
