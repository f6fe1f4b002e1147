/* The vectors. */
#include "cortex_m.h"
#include "disturbance.h"
#include "drivers.h"
#include "stm32f405.h"

#define IRQ_COUNT 82u

typedef struct {
    cortex_m_vectors_t core;
    cortex_m_vector_t  irq[IRQ_COUNT];
} vectors_t;

extern const vectors_t vectors;

/* A program without a driver, a suite of tests say, has 0 in place of its interrupt. */
#pragma weak edge_interrupt
#pragma weak bus_interrupt
#pragma weak disturbance_interrupt
#pragma weak scan_interrupt

/* Interrupts without a handler of their own are never enabled, and stay at 0. */
__attribute__((section(".vectors"), used)) const vectors_t vectors = {
    .core = CORTEX_M_VECTORS(scan_interrupt),
    .irq =
        {
            [IRQ_EXTI0] = edge_interrupt,
            [IRQ_USART1] = bus_interrupt,
            [IRQ_USART6] = disturbance_interrupt,
        },
};
