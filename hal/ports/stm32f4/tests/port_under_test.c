/*
 * The STM32F4 port under test: the interrupt output of USART3 is wired to the trigger pin by the
 * emulator of its rig. Time passes by TIM4, which has 32 bits there.
 */
#include "../board.h"
#include "../stm32f405.h"
#include "tests/wired_board.h"

const uint32_t WIRED_TICKS_PER_US = BOARD_TIMER_MHZ;

void wired_let_uart(bool may_interrupt)
{
    cortex_m_let_irq(IRQ_USART1, may_interrupt);
}

void wired_start(void)
{
    board_start_counter(TIM4, 1u, 0u);
}

uint32_t wired_ticks(void)
{
    return TIM_CNT(TIM4);
}

/* An empty transmitter asks for the next byte. */
void wired_set_line(bool high)
{
    USART_CR1(USART3) = high ? CR1_EMPTY_IRQ : 0u;
}
