/* The trigger line: GP2 with its edge interrupt. */
#include "hal_edge.h"

#include "board.h"
#include "disturbance.h"
#include "drivers.h"
#include "hal_clock.h"
#include "hal_edge_events.h"
#include "hal_error.h"
#include "rp2040.h"

#define CHANNEL 0u
#define PIN     2u
#define RISES   EVENT_RISES(PIN)
#define FALLS   EVENT_FALLS(PIN)

static volatile bool edge_armed;
static volatile bool edge_active_low;

/* An edge that has got as far as the pin's register or the interrupt controller is dropped. */
static void stop_watching(void)
{
    CLEAR_OF(IO_INTE0(BOARD_EDGE_CORE)) = RISES | FALLS;
    edge_armed = false;
    IO_INTR0 = RISES | FALLS;
    NVIC_ICPR(IRQ_IO_BANK0) = NVIC_BIT(IRQ_IO_BANK0);
}

void edge_start(void)
{
    edge_active_low = false;
    PADS(PIN) = PAD_INPUT | PAD_SCHMITT | PAD_PULL_DOWN;
    IO_CTRL(PIN) = IO_SIO;
    stop_watching();
    cortex_m_enable_irq(IRQ_IO_BANK0, PRIORITY_EDGE);
}

bool edge_pin_is_high(void)
{
    return (SIO_GPIO_IN & 1u << PIN) != 0u;
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
    edge_armed = true;
    if (DISTURBANCE_FILTER_SAMPLES == 0u) {
        SET_OF(IO_INTE0(BOARD_EDGE_CORE)) = config->active_low ? FALLS : RISES;
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
    return channel == CHANNEL && disturbance_filtered(edge_pin_is_high()) != edge_active_low;
}

/* The clock before anything else. */
void edge_interrupt(void)
{
    uint32_t captured_ticks = hal_clock_now_ticks();

    if ((IO_INTS0(BOARD_EDGE_CORE) & (RISES | FALLS)) != 0u) {
        IO_INTR0 = RISES | FALLS;
        hal_edge_on_latch(CHANNEL, captured_ticks);
    }
}

void edge_on_filtered(bool is_high)
{
    if (edge_armed && is_high != edge_active_low) {
        hal_edge_on_latch(CHANNEL, hal_clock_now_ticks());
    }
}
