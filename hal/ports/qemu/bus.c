/*
 * The report bus: a queue that the UART's transmit interrupt empties byte by byte; each byte that
 * has left asks for the next.
 */
#include "hal_bus.h"

#include <stdbool.h>
#include <stdint.h>

#include "drivers.h"
#include "hal_critical.h"
#include "hal_error.h"

#define QUEUE_BYTES 64u /* a power of two: four records */

static uint8_t          queue[QUEUE_BYTES];
static volatile uint8_t queued; /* counts up and wraps */
static volatile uint8_t sent;
static volatile bool    is_sending;

void bus_start(void)
{
    queued = 0u;
    sent = 0u;
    is_sending = false;
    uart_start();
}

static void send_next(void)
{
    is_sending = sent != queued;
    if (is_sending) {
        uart_send_byte(queue[sent % QUEUE_BYTES]);
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

void bus_interrupt(void)
{
    uart_forget_sent();
    send_next();
}
