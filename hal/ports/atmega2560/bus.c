#include "bus.h"

#include <avr/interrupt.h>
#include <avr/io.h>

#include "hal_bus.h"
#include "hal_critical.h"
#include "hal_error.h"

#define QUEUE_BYTES 64u /* a power of two; one byte stays free, so seven frames fit */
#define BAUD_500K   3u  /* 16 MHz / 8 / (3 + 1) */

/* The task moves `head`, the interrupt `tail`; each is one byte, so it is read whole. */
static volatile uint8_t queue[QUEUE_BYTES];
static volatile uint8_t head;
static volatile uint8_t tail;

static uint8_t after(uint8_t place)
{
    return (uint8_t)((place + 1u) % QUEUE_BYTES);
}

ISR(USART0_UDRE_vect)
{
    if (tail == head) {
        UCSR0B &= (uint8_t)~(1u << UDRIE0);
        return;
    }
    UDR0 = queue[tail];
    tail = after(tail);
}

void bus_start(void)
{
    UCSR0B = 0u;
    head = 0u;
    tail = 0u;
    UBRR0 = BAUD_500K;
    UCSR0A = 1u << U2X0;
    UCSR0C = (1u << UCSZ01) | (1u << UCSZ00);
    UCSR0B = (1u << TXEN0) | (1u << RXEN0);
}

bool bus_take_byte(uint8_t *byte)
{
    if ((UCSR0A & (1u << RXC0)) == 0u) {
        return false;
    }
    *byte = UDR0;
    return true;
}

static uint8_t room_bytes(void)
{
    return (uint8_t)((uint8_t)(tail + QUEUE_BYTES - 1u - head) % QUEUE_BYTES);
}

int hal_bus_send(const uint8_t frame[HAL_BUS_FRAME_BYTES])
{
    if (room_bytes() < HAL_BUS_FRAME_BYTES) {
        return HAL_ERR_BUSY;
    }
    for (uint8_t i = 0u; i < HAL_BUS_FRAME_BYTES; ++i) {
        queue[head] = frame[i];
        head = after(head);
    }
    hal_critical_state_t saved = hal_critical_enter();
    UCSR0B |= 1u << UDRIE0;
    hal_critical_exit(saved);
    return HAL_OK;
}
