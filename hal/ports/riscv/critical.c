#include "hal_critical.h"
#include "riscv.h"

hal_critical_state_t hal_critical_enter(void)
{
    hal_critical_state_t saved;
    __asm__ volatile("csrrci %0, mstatus, 8" : "=r"(saved) : : "memory");
    return saved & MSTATUS_MIE;
}

void hal_critical_exit(hal_critical_state_t saved)
{
    CSR_SET(mstatus, saved);
}
