/* From reset to main(): vectors, and memory as C wants it. */
#include <stdint.h>

#include "board.h"
#include "disturbance.h"
#include "lm3s6965.h"

#define IRQ_COUNT 48u

typedef void (*vector_t)(void);

typedef struct {
    const uint32_t *stack_end;
    vector_t        core[15];
    vector_t        irq[IRQ_COUNT];
} vectors_t;

/* Of the linker script. */
extern const uint32_t link_data_load[];
extern uint32_t       link_data_start[];
extern uint32_t       link_data_end[];
extern uint32_t       link_bss_end[];
extern const uint32_t link_stack_end[];

extern const vectors_t vectors;

/* A program without a driver, a suite of tests say, has 0 in place of its interrupt. */
#pragma weak clock_on_wrap
#pragma weak edge_interrupt
#pragma weak bus_interrupt
#pragma weak disturbance_interrupt
#pragma weak scan_interrupt
#pragma weak axis_on_step

int  main(void);
void reset(void);

/* A debugger finds the program here, with what led to it on the stack. */
static void stay(void)
{
    for (;;) {
    }
}

void reset(void)
{
    const uint32_t *from = link_data_load;
    uint32_t       *to = link_data_start;
    while (to < link_data_end) {
        *to++ = *from++;
    }
    while (to < link_bss_end) {
        *to++ = 0u;
    }
    (void)main();
    stay();
}

/* Interrupts without a handler of their own are never enabled, and stay at 0. */
__attribute__((section(".vectors"), used)) const vectors_t vectors = {
    .stack_end = link_stack_end,
    .core = {reset, stay, stay, stay, stay, stay, 0, 0, 0, 0, stay, stay, 0, stay, clock_on_wrap},
    .irq =
        {
            [IRQ_GPIO_C] = edge_interrupt,
            [IRQ_UART0] = bus_interrupt,
            [IRQ_TIMER0] = disturbance_interrupt,
            [IRQ_TIMER1] = scan_interrupt,
            [IRQ_TIMER2] = axis_on_step,
        },
};
