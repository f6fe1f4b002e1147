#include <avr/interrupt.h>
#include <avr/io.h>

#include "hal_critical.h"

#define BARRIER() __asm__ volatile("" ::: "memory")

hal_critical_state_t hal_critical_enter(void)
{
    uint8_t saved = SREG;
    cli();
    BARRIER();
    return saved;
}

void hal_critical_exit(hal_critical_state_t saved)
{
    BARRIER();
    SREG = (uint8_t)saved;
}
