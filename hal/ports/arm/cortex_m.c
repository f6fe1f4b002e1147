#include "cortex_m.h"

/* The priority registers are written as words: that is all that the smaller cores can. */
void cortex_m_enable_irq(uint32_t irq, cortex_m_priority_t priority)
{
    uint32_t shift = 8u * (irq % 4u);
    uint32_t others = NVIC_IPR(irq) & ~(0xFFu << shift);

    NVIC_IPR(irq) = others | (uint32_t)priority << (shift + PRIORITY_SHIFT);
    NVIC_ICPR(irq) = NVIC_BIT(irq);
    NVIC_ISER(irq) = NVIC_BIT(irq);
}

void cortex_m_let_irq(uint32_t irq, bool may_come)
{
    if (may_come) {
        NVIC_ISER(irq) = NVIC_BIT(irq);
    } else {
        NVIC_ICER(irq) = NVIC_BIT(irq);
    }
}
