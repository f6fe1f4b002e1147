/* UART0 without its FIFO. */
#include "cortex_m.h"
#include "drivers.h"
#include "lm3s6965.h"

#define BAUD_WHOLE 27u /* 50 MHz / (16 · 115,200) = 27 + 8/64 */
#define BAUD_64THS 8u
#define NO_BYTE    (-1)

void uart_start(void)
{
    UART_CTL(UART0) = 0u;
    UART_IBRD(UART0) = BAUD_WHOLE;
    UART_FBRD(UART0) = BAUD_64THS;
    UART_LCRH(UART0) = LCRH_8_BITS;
    UART_ICR(UART0) = UART_TX;
    UART_IM(UART0) = UART_TX;
    UART_CTL(UART0) = CTL_ENABLE;
    cortex_m_enable_irq(IRQ_UART0, PRIORITY_UART);
}

void uart_forget_sent(void)
{
    UART_ICR(UART0) = UART_TX;
}

void uart_send_byte(uint8_t byte)
{
    UART_DR(UART0) = byte;
}

int uart_take_byte(void)
{
    return (UART_FR(UART0) & FR_RX_EMPTY) == 0u ? (int)(UART_DR(UART0) & UINT8_MAX) : NO_BYTE;
}
