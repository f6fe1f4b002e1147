#include "board.h"
#include "rp2040.h"
#include "vectors.h"

#pragma weak axis_on_step

VECTORS(IRQ_COUNT, scan_interrupt,             /* SysTick */
        [IRQ_TIMER_0] = disturbance_interrupt, /* off in most builds */
        [IRQ_PWM_WRAP] = axis_on_step,         /* a step */
        [IRQ_IO_BANK0] = edge_interrupt,       /* the trigger line */
        [IRQ_UART0] = bus_interrupt);          /* a byte has left */
