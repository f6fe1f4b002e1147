/* The trigger line: PA0, by line 0 of the edge interrupts. */
#include "hal_edge.h"

#include "board.h"
#include "drivers.h"
#include "hal_clock.h"
#include "hal_edge_events.h"
#include "hal_error.h"
#include "stm32f405.h"

#define CHANNEL 0u
#define PIN     0u
#define LINE    (1u << PIN)

/* Where the level of the pin is read. */
#ifndef EDGE_LEVEL_REGISTER
#define EDGE_LEVEL_REGISTER GPIOA_IDR_ADDRESS
#define EDGE_LEVEL_BIT      PIN
#endif

static volatile bool edge_active_low;

/* An edge that has got as far as the line's register or the interrupt controller is dropped. */
static void stop_watching(void)
{
    EXTI_IMR &= ~LINE;
    EXTI_PR = LINE;
    NVIC_ICPR(IRQ_EXTI0) = NVIC_BIT(IRQ_EXTI0);
}

void edge_start(void)
{
    edge_active_low = false;
    GPIOA_MODER &= ~MODER_MASK(PIN);
    GPIOA_PUPDR |= PUPDR_DOWN(PIN);
    SYSCFG_EXTICR1 &= ~0xFu;
    stop_watching();
    cortex_m_enable_irq(IRQ_EXTI0, PRIORITY_EDGE);
}

bool edge_pin_is_high(void)
{
    return (REGISTER(EDGE_LEVEL_REGISTER) & 1u << EDGE_LEVEL_BIT) != 0u;
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
    EXTI_RTSR = config->active_low ? EXTI_RTSR & ~LINE : EXTI_RTSR | LINE;
    EXTI_FTSR = config->active_low ? EXTI_FTSR | LINE : EXTI_FTSR & ~LINE;
    EXTI_PR = LINE; /* the change of polarity may look like an edge */
    EXTI_IMR |= LINE;
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

    if ((EXTI_PR & EXTI_IMR & LINE) != 0u) {
        EXTI_PR = LINE;
        hal_edge_on_latch(CHANNEL, captured_ticks);
    }
}
