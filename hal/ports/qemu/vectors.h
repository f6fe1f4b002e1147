/*
 * The vector table of a Cortex-M with these drivers. Each board's startup.c defines `vectors` by
 * it, with what goes to its interrupts.
 */
#ifndef QEMU_VECTORS_H
#define QEMU_VECTORS_H

#include <stdint.h>

#include "disturbance.h"
#include "drivers.h"
#include "reset.h"

/* A program without a driver, a suite of tests say, has 0 in place of its interrupt. */
#pragma weak edge_interrupt
#pragma weak bus_interrupt
#pragma weak disturbance_interrupt
#pragma weak scan_interrupt

typedef void (*vector_t)(void);

/* The end of the stack, of the linker script. */
extern const uint32_t link_stack_end[];

/*
 * Defines it, for irq_count interrupts. Those that are not named are never enabled, and stay at 0.
 */
#define VECTORS(irq_count, systick, ...)                                                         \
    typedef struct {                                                                             \
        const uint32_t *stack_end;                                                               \
        vector_t        core[15];                                                                \
        vector_t        irq[irq_count];                                                          \
    } vectors_t;                                                                                 \
    extern const vectors_t                                     vectors;                          \
    __attribute__((section(".vectors"), used)) const vectors_t vectors = {                       \
        .stack_end = link_stack_end,                                                             \
        .core = {reset, stay, stay, stay, stay, stay, 0, 0, 0, 0, stay, stay, 0, stay, systick}, \
        .irq = {__VA_ARGS__},                                                                    \
    }

#endif
