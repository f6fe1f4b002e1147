#include "riscv.h"

uint64_t riscv_cycles(void)
{
    uint32_t high, low;
    do {
        high = CSR_READ(mcycleh);
        low = CSR_READ(mcycle);
    } while (CSR_READ(mcycleh) != high);
    return (uint64_t)high << 32 | low;
}

void riscv_enable_irq(uint32_t irq, riscv_priority_t priority)
{
    PLIC_PRIORITY(irq) = priority;
    PLIC_ENABLE(irq) |= PLIC_BIT(irq);
    CSR_SET(mie, MIE_EXTERNAL);
}
