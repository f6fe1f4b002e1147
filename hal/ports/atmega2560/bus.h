/* The report bus: UART 0 at 500 kBd, eight bits, no parity; TXD on PE1, RXD on PE0. */
#ifndef ATMEGA2560_BUS_H
#define ATMEGA2560_BUS_H

#include <stdbool.h>
#include <stdint.h>

#define BUS_FRAME_US 160u /* one frame on the wire */

/* Start with an empty queue; what was on its way is dropped. Task. */
void bus_start(void);

/* Take one byte that came in. False if there is none. Task. */
bool bus_take_byte(uint8_t *byte);

#endif
