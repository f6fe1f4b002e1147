/*
 * UART0 without its FIFO. The interrupt of a byte that has left is let come while there is one: the
 * emulated UART asks for it at all times.
 */
#include "drivers.h"
#include "rp2040.h"

#define BAUD_WHOLE 67u /* 125 MHz / (16 · 115,200) = 67 + 52/64 */
#define BAUD_64THS 52u
#define NO_BYTE    (-1)

void uart_start(void)
{
    UART0_CR = 0u;
    UART0_IBRD = BAUD_WHOLE;
    UART0_FBRD = BAUD_64THS;
    UART0_LCRH = LCRH_8_BITS;
    uart_forget_sent();
    UART0_CR = CR_ENABLE;
    cortex_m_enable_irq(IRQ_UART0, PRIORITY_UART);
}

void uart_forget_sent(void)
{
    UART0_IMSC = 0u;
    UART0_ICR = UART_TX;
}

void uart_send_byte(uint8_t byte)
{
    UART0_DR = byte;
    UART0_IMSC = UART_TX;
}

int uart_take_byte(void)
{
    return (UART0_FR & FR_RX_EMPTY) == 0u ? (int)(UART0_DR & UINT8_MAX) : NO_BYTE;
}
