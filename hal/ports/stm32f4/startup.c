#include "stm32f405.h"
#include "vectors.h"

#define IRQ_COUNT 82u

VECTORS(IRQ_COUNT, scan_interrupt,    /* SysTick */
        [IRQ_EXTI0] = edge_interrupt, /* the trigger line */
        [IRQ_USART1] = bus_interrupt, /* a byte has left */
        [IRQ_USART6] = disturbance_interrupt);
