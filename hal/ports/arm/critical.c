#include "hal_critical.h"

hal_critical_state_t hal_critical_enter(void)
{
    hal_critical_state_t saved;
    __asm__ volatile("mrs %0, primask\n\tcpsid i" : "=r"(saved) : : "memory");
    return saved;
}

void hal_critical_exit(hal_critical_state_t saved)
{
    __asm__ volatile("msr primask, %0" : : "r"(saved) : "memory");
}
