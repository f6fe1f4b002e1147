/* The vectors. */
#include "disturbance.h"
#include "drivers.h"
#include "fu540.h"

/* A program without a driver, a suite of tests say, never enables its interrupt. */
#pragma weak edge_interrupt
#pragma weak bus_interrupt
#pragma weak disturbance_interrupt
#pragma weak scan_interrupt

__attribute__((interrupt)) void software_trap(void)
{
    disturbance_interrupt();
}

/* Edges are let in. */
__attribute__((interrupt)) void timer_trap(void)
{
    riscv_opened_t saved = riscv_open();
    scan_interrupt();
    riscv_close(saved);
}

__attribute__((interrupt)) void external_trap(void)
{
    uint32_t irq = PLIC_CLAIM;

    if (irq == IRQ_UART0) {
        bus_interrupt();
    } else if (irq != 0u) {
        edge_interrupt();
    }
    PLIC_CLAIM = irq;
}
