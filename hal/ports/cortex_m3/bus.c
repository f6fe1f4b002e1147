/*
 * The report bus: UART0 at 115,200 baud. A queue that the transmit interrupt empties byte by byte;
 * without the FIFO, so that each byte that has left asks for the next.
 */
#include "hal_bus.h"

#include "board.h"
#include "hal_critical.h"
#include "hal_error.h"
#include "lm3s6965.h"

#define QUEUE_BYTES 64u /* a power of two: four records */
#define BAUD_WHOLE  27u /* 50 MHz / (16 · 115,200) = 27 + 8/64 */
#define BAUD_64THS  8u
#define NO_BYTE     (-1)

static uint8_t          queue[QUEUE_BYTES];
static volatile uint8_t queued; /* counts up and wraps */
static volatile uint8_t sent;
static volatile bool    is_sending;

void bus_start(void)
{
    queued = 0u;
    sent = 0u;
    is_sending = false;
    UART_CTL(UART0) = 0u;
    UART_IBRD(UART0) = BAUD_WHOLE;
    UART_FBRD(UART0) = BAUD_64THS;
    UART_LCRH(UART0) = LCRH_8_BITS;
    UART_ICR(UART0) = UART_TX;
    UART_IM(UART0) = UART_TX;
    UART_CTL(UART0) = CTL_ENABLE;
    board_enable_irq(IRQ_UART0, PRIORITY_UART);
}

static void send_next(void)
{
    is_sending = sent != queued;
    if (is_sending) {
        UART_DR(UART0) = queue[sent % QUEUE_BYTES];
        ++sent;
    }
}

int hal_bus_send(const uint8_t frame[HAL_BUS_FRAME_BYTES])
{
    if ((uint8_t)(queued - sent) > QUEUE_BYTES - HAL_BUS_FRAME_BYTES) {
        return HAL_ERR_BUSY;
    }
    for (uint8_t i = 0u; i < HAL_BUS_FRAME_BYTES; ++i) {
        queue[(uint8_t)(queued + i) % QUEUE_BYTES] = frame[i];
    }
    hal_critical_state_t saved = hal_critical_enter();
    queued = (uint8_t)(queued + HAL_BUS_FRAME_BYTES);
    if (!is_sending) {
        send_next();
    }
    hal_critical_exit(saved);
    return HAL_OK;
}

int bus_take_byte(void)
{
    return (UART_FR(UART0) & FR_RX_EMPTY) == 0u ? (int)(UART_DR(UART0) & UINT8_MAX) : NO_BYTE;
}

void bus_interrupt(void)
{
    UART_ICR(UART0) = UART_TX;
    send_next();
}
