/* The report bus as a UART: frames as they are, and command bytes the other way. */
#ifndef ATMEGA328P_BUS_H
#define ATMEGA328P_BUS_H

#include <stdbool.h>
#include <stdint.h>

#define BUS_BYTE_US 40u /* one byte at 250 kBd, start and stop bit included */

/* Task, once, interrupts masked. */
void bus_start(void);

/* Take the next byte that came in, within two bytes' time. False if there is none. Task. */
bool bus_take_byte(uint8_t *byte);

#endif
