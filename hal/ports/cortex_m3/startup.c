#include "board.h"
#include "lm3s6965.h"
#include "vectors.h"

#pragma weak clock_on_wrap
#pragma weak axis_on_step

#define IRQ_COUNT 48u

VECTORS(IRQ_COUNT, clock_on_wrap,             /* SysTick */
        [IRQ_GPIO_C] = edge_interrupt,        /* the trigger line */
        [IRQ_UART0] = bus_interrupt,          /* a byte has left */
        [IRQ_TIMER0] = disturbance_interrupt, /* off in most builds */
        [IRQ_TIMER1] = scan_interrupt,        /* of the PLC */
        [IRQ_TIMER2] = axis_on_step);
