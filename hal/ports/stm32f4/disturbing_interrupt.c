/* An interrupt nobody else uses, as urgent as the edge's, that the task raises when it is due. */
#include "disturbance.h"
#include "stm32f405.h"

/* A constant that is 0 in most builds. */
static const uint32_t INTERRUPT_US = DISTURBANCE_INTERRUPT_US;

static uint32_t interrupt_since_ticks;

void disturbance_start(void)
{
    if (INTERRUPT_US != 0u) {
        cortex_m_enable_irq(IRQ_USART6, PRIORITY_EDGE);
    }
}

void disturbance_in_task(void)
{
    disturbance_critical_section();
    if (INTERRUPT_US != 0u &&
        disturbance_is_due(&interrupt_since_ticks, DISTURBANCE_INTERRUPT_PERIOD_US)) {
        NVIC_ISPR(IRQ_USART6) = NVIC_BIT(IRQ_USART6);
    }
}

void disturbance_interrupt(void)
{
    disturbance_work(INTERRUPT_US);
}
