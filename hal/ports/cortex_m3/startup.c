/* The vectors. */
#include "board.h"
#include "cortex_m.h"
#include "disturbance.h"
#include "drivers.h"
#include "lm3s6965.h"

#define IRQ_COUNT 48u

typedef struct {
    cortex_m_vectors_t core;
    cortex_m_vector_t  irq[IRQ_COUNT];
} vectors_t;

extern const vectors_t vectors;

/* A program without a driver, a suite of tests say, has 0 in place of its interrupt. */
#pragma weak clock_on_wrap
#pragma weak edge_interrupt
#pragma weak bus_interrupt
#pragma weak disturbance_interrupt
#pragma weak scan_interrupt
#pragma weak axis_on_step

/* Interrupts without a handler of their own are never enabled, and stay at 0. */
__attribute__((section(".vectors"), used)) const vectors_t vectors = {
    .core = CORTEX_M_VECTORS(clock_on_wrap),
    .irq =
        {
            [IRQ_GPIO_C] = edge_interrupt,
            [IRQ_UART0] = bus_interrupt,
            [IRQ_TIMER0] = disturbance_interrupt,
            [IRQ_TIMER1] = scan_interrupt,
            [IRQ_TIMER2] = axis_on_step,
        },
};
