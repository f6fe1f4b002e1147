#include "board.h"

#include "drivers.h"
#include "rp2040.h"

#define TXD 0u
#define RXD 1u

#define PERIPHERALS \
    (RESET_IO_BANK0 | RESET_PADS_BANK0 | RESET_PLL_SYS | RESET_PWM | RESET_TIMER | RESET_UART0)

static void start_peripherals(void)
{
    CLEAR_OF(RESETS_RESET) = PERIPHERALS;
    while ((RESETS_DONE & PERIPHERALS) != PERIPHERALS) {
    }
}

/* 12 MHz of the crystal; the timer counts µs of it. */
static void start_crystal(void)
{
    XOSC_STARTUP = XOSC_STARTUP_1_MS;
    XOSC_CTRL = XOSC_ON_12_MHZ;
    while ((XOSC_STATUS & XOSC_STABLE) == 0u) {
    }
    CLK_REF_CTRL = REF_FROM_XOSC;
    while ((CLK_REF_SELECTED & 1u << REF_FROM_XOSC) == 0u) {
    }
    WATCHDOG_TICK = TICK_ON | 12u;
}

/* 12 MHz · 125 / 6 / 2 = 125 MHz, in the order of the data sheet. */
static void start_pll(void)
{
    PLL_SYS_CS = PLL_REFERENCE_BY_1;
    PLL_SYS_FBDIV = 125u;
    CLEAR_OF(PLL_SYS_PWR) = PWR_OFF | PWR_OSCILLATOR_OFF;
    while ((PLL_SYS_CS & PLL_LOCKED) == 0u) {
    }
    PLL_SYS_PRIM = PRIM_BY(6u, 2u);
    CLEAR_OF(PLL_SYS_PWR) = PWR_DIVIDER_OFF;
    CLK_SYS_CTRL = SYS_FROM_PLL;
    while ((CLK_SYS_SELECTED & 1u << SYS_FROM_PLL) == 0u) {
    }
    CLK_PERI_CTRL = PERI_FROM_SYS;
}

void board_start(void)
{
    start_peripherals();
    start_crystal();
    start_pll();
    PADS(RXD) = PAD_INPUT | PAD_SCHMITT | PAD_PULL_UP;
    IO_CTRL(TXD) = IO_UART;
    IO_CTRL(RXD) = IO_UART;
    clock_start(0u);
    edge_start();
    axis_place(0);
    bus_start();
}

void board_start_slice(uint32_t slice, uint32_t top)
{
    PWM_CSR(slice) = 0u;
    PWM_DIV(slice) = PWM_BY(BOARD_CORE_MHZ);
    PWM_TOP(slice) = top;
    PWM_CTR(slice) = 0u;
    PWM_INTR = PWM_SLICE(slice);
    PWM_CSR(slice) = PWM_RUN;
}
