/*
 * The report bus as UART 0: frames as they are, and command bytes the other way. The board's own
 * `board.h` says BOARD_BUS_BAUD, a divisor of 2 MBd.
 */
#ifndef ATMEGA_UART_BUS_H
#define ATMEGA_UART_BUS_H

#include <stdbool.h>
#include <stdint.h>

#include "board.h"

#define BUS_BYTE_US (10000000ul / BOARD_BUS_BAUD) /* start and stop bit included */

/* Start with an empty queue; what was on its way is dropped. Task, interrupts masked. */
void bus_start(void);

/* Take the next byte that came in, within two bytes' time. False if there is none. Task. */
bool bus_take_byte(uint8_t *byte);

#endif
