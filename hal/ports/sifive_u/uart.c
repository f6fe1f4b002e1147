/* UART0, one byte at a time: its interrupt is on while one is on its way. */
#include "drivers.h"
#include "fu540.h"

#define CYCLES_A_BIT 4340u /* 500 MHz / 115,200 */
#define NO_BYTE      (-1)

void uart_start(void)
{
    UART_IE(UART0) = 0u;
    UART_DIV(UART0) = CYCLES_A_BIT - 1u;
    UART_TXC(UART0) = TXC_ENABLE | TXC_BELOW(1u);
    UART_RXC(UART0) = RXC_ENABLE;
    riscv_enable_irq(IRQ_UART0, PRIORITY_UART);
}

/* The request lasts while nothing waits to be sent. */
void uart_forget_sent(void)
{
    UART_IE(UART0) = 0u;
}

void uart_send_byte(uint8_t byte)
{
    UART_TX(UART0) = byte;
    UART_IE(UART0) = IE_TX;
}

int uart_take_byte(void)
{
    uint32_t received = UART_RX(UART0);
    return (received & RX_EMPTY) == 0u ? (int)(received & UINT8_MAX) : NO_BYTE;
}
