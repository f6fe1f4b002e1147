/* The software interrupt, which nobody else uses: the task raises it when it is due. */
#include "disturbance.h"
#include "riscv.h"

/* A constant that is 0 in most builds. */
static const uint32_t INTERRUPT_US = DISTURBANCE_INTERRUPT_US;

static uint32_t interrupt_since_ticks;

void disturbance_start(void)
{
    if (INTERRUPT_US != 0u) {
        CSR_SET(mie, MIE_SOFTWARE);
    }
}

void disturbance_in_task(void)
{
    disturbance_critical_section();
    if (INTERRUPT_US != 0u &&
        disturbance_is_due(&interrupt_since_ticks, DISTURBANCE_INTERRUPT_PERIOD_US)) {
        CLINT_MSIP = 1u;
    }
}

void disturbance_interrupt(void)
{
    CLINT_MSIP = 0u;
    disturbance_work(INTERRUPT_US);
}
