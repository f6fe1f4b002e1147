/*
 * The RP2040 port under test: its GP3 is wired to the trigger pin. Time passes by a PWM slice of 16
 * bits, which is read often enough while time is let pass.
 */
#include "../board.h"
#include "../rp2040.h"
#include "tests/wired_board.h"

#define DRIVER 3u

const uint32_t WIRED_TICKS_PER_US = 1u;

static uint32_t ticks;

void wired_let_uart(bool may_interrupt)
{
    cortex_m_let_irq(IRQ_UART0, may_interrupt);
}

void wired_start(void)
{
    board_start_slice(SLICE_FREE, UINT16_MAX);
    SIO_GPIO_CLEAR = 1u << DRIVER;
    SIO_OE_SET = 1u << DRIVER;
    PADS(DRIVER) = PAD_4_MA;
    IO_CTRL(DRIVER) = IO_SIO;
}

uint32_t wired_ticks(void)
{
    ticks += (uint16_t)(PWM_CTR(SLICE_FREE) - ticks);
    return ticks;
}

void wired_set_line(bool high)
{
    if (high) {
        SIO_GPIO_SET = 1u << DRIVER;
    } else {
        SIO_GPIO_CLEAR = 1u << DRIVER;
    }
}
