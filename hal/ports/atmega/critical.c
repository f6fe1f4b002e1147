#include <avr/interrupt.h>
#include <avr/io.h>

#include "hal_critical.h"

/* cli() is a barrier to the compiler by itself, a write to SREG is not. */
#define BARRIER() __asm__ volatile("" ::: "memory")

hal_critical_state_t hal_critical_enter(void)
{
    uint8_t saved = SREG;
    cli();
    return saved;
}

void hal_critical_exit(hal_critical_state_t saved)
{
    BARRIER();
    SREG = (uint8_t)saved;
    BARRIER();
}
