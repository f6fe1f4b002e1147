/* USART1; each byte that has left raises the flag of a finished transmission. */
#include "drivers.h"
#include "stm32f405.h"

#define BAUD_RATIO 694u /* 80 MHz / 115,200; APB2 */
#define NO_BYTE    (-1)

void uart_start(void)
{
    USART_CR1(USART1) = 0u;
    USART_BRR(USART1) = BAUD_RATIO;
    uart_forget_sent();
    USART_CR1(USART1) = CR1_ENABLE | CR1_SENT_IRQ;
    cortex_m_enable_irq(IRQ_USART1, PRIORITY_UART);
}

/* The flags are cleared by a 0, and a 1 leaves them. */
void uart_forget_sent(void)
{
    USART_SR(USART1) = UINT16_MAX & ~SR_SENT;
}

void uart_send_byte(uint8_t byte)
{
    USART_DR(USART1) = byte;
}

int uart_take_byte(void)
{
    return (USART_SR(USART1) & SR_RECEIVED) != 0u ? (int)(USART_DR(USART1) & UINT8_MAX) : NO_BYTE;
}
