/*
 * The FU540 port under test: PWM0's first compare interrupt is wired to the trigger pin by
 * the emulator of its rig. Time passes by PWM1, 2 ns a count of 31 bits.
 */
#include "../fu540.h"
#include "tests/wired_board.h"

#define CMPS 4u

const uint32_t WIRED_TICKS_PER_US = 1000u;

/* By its priority: after a change of what is enabled, QEMU 7.2 does not look again. */
void wired_let_uart(bool may_interrupt)
{
    PLIC_PRIORITY(IRQ_UART0) = may_interrupt ? PRIORITY_UART : 0u;
}

void wired_start(void)
{
    for (uint32_t n = 0u; n < CMPS; ++n) {
        PWM_CMP(PWM0, n) = n == 0u ? 1u : UINT16_MAX;
        PWM_CMP(PWM1, n) = UINT16_MAX; /* the emulator would be busy with what is reached */
    }
    PWM_CFG(PWM1) = PWM_RUN | PWM_SCALE_MAX;
}

uint32_t wired_ticks(void)
{
    return PWM_COUNT(PWM1) << 1;
}

void wired_set_line(bool high)
{
    PWM_CFG(PWM0) = 0u;
    if (high) {
        PWM_COUNT(PWM0) = 0u;
        PWM_CFG(PWM0) = PWM_RUN_ONCE;
    }
}
