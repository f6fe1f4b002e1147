#include "uart_bus.h"

#include <avr/interrupt.h>

#include "hal_bus.h"
#include "hal_critical.h"
#include "hal_error.h"

/* A chip with one UART leaves its number out. */
#ifndef USART_UDRE_vect
#define USART_UDRE_vect USART0_UDRE_vect
#endif

#define DIVIDER     8u  /* with U2X0 */
#define QUEUE_BYTES 64u /* a power of two; four records */

static uint8_t          queue[QUEUE_BYTES];
static volatile uint8_t queued; /* bytes since the start, both modulo 256 */
static volatile uint8_t sent;

ISR(USART_UDRE_vect)
{
    uint8_t next = sent;
    UDR0 = queue[next % QUEUE_BYTES];
    sent = ++next;
    if (next == queued) {
        UCSR0B &= (uint8_t)~_BV(UDRIE0);
    }
}

void bus_start(void)
{
    UCSR0B = 0u;
    sent = queued;
    UCSR0A = _BV(U2X0);
    UBRR0 = BOARD_CLOCK_HZ / DIVIDER / BOARD_BUS_BAUD - 1u;
    UCSR0C = _BV(UCSZ01) | _BV(UCSZ00);
    UCSR0B = _BV(RXEN0) | _BV(TXEN0);
}

/* The interrupt sees the frame whole: it is switched on, under the lock, once all bytes are in. */
int hal_bus_send(const uint8_t frame[HAL_BUS_FRAME_BYTES])
{
    uint8_t end = queued;
    if ((uint8_t)(end - sent) > QUEUE_BYTES - HAL_BUS_FRAME_BYTES) {
        return HAL_ERR_BUSY;
    }
    for (uint8_t i = 0u; i < HAL_BUS_FRAME_BYTES; ++i) {
        queue[(uint8_t)(end + i) % QUEUE_BYTES] = frame[i];
    }
    hal_critical_state_t saved = hal_critical_enter();
    queued = (uint8_t)(end + HAL_BUS_FRAME_BYTES);
    UCSR0B |= _BV(UDRIE0);
    hal_critical_exit(saved);
    return HAL_OK;
}

bool bus_take_byte(uint8_t *byte)
{
    if ((UCSR0A & _BV(RXC0)) == 0u) {
        return false;
    }
    *byte = UDR0;
    return true;
}
