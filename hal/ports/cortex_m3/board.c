#include "board.h"

#include "drivers.h"
#include "lm3s6965.h"

#define UART_PINS 3u /* PA0, PA1 */

/* 50 MHz out of the PLL, in the order of the data sheet: nothing runs from it before it is locked.
 */
static void start_clocks(void)
{
    uint32_t rcc = RCC_MOSC_ON | RCC_XTAL_8_MHZ | RCC_USE_DIVIDER | RCC_DIVIDE_BY_4;

    SYSCTL_RCC |= RCC_BYPASS;
    SYSCTL_RCC = rcc | RCC_BYPASS;
    while ((SYSCTL_RIS & RIS_PLL_LOCKED) == 0u) {
    }
    SYSCTL_RCC = rcc;
    SYSCTL_RCGC1 =
        RCGC1_UART0 | RCGC1_TIMER(0u) | RCGC1_TIMER(1u) | RCGC1_TIMER(2u) | RCGC1_TIMER(3u);
    SYSCTL_RCGC2 = RCGC2_GPIO_A | RCGC2_GPIO_C;
    (void)SYSCTL_RCGC2; /* the clocks take effect some cycles later */
    (void)SYSCTL_RCGC2;
}

void board_start(void)
{
    start_clocks();
    GPIO_AFSEL(GPIO_A) = UART_PINS;
    GPIO_DEN(GPIO_A) = UART_PINS;
    clock_start(0u);
    edge_start();
    axis_place(0);
    bus_start();
}

void board_start_timer(uint32_t number, uint32_t period_ticks)
{
    TIMER_CTL(number) = 0u;
    TIMER_CFG(number) = 0u;
    TIMER_TAMR(number) = TAMR_PERIODIC;
    TIMER_TAILR(number) = period_ticks - 1u;
    TIMER_ICR(number) = TIMER_A;
    TIMER_IMR(number) = TIMER_A;
    TIMER_CTL(number) = TIMER_A;
}
