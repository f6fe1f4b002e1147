/* The device clock: Timer 1 at the processor's 16 MHz, extended to 32 bits by its overflows. */
#ifndef ATMEGA2560_CLOCK_H
#define ATMEGA2560_CLOCK_H

#include <stdint.h>

/* Start the clock at `ticks`, or set it while it runs. Task. */
void clock_start(uint32_t ticks);

/*
 * The reading at which the low half was `captured`, up to 65535 ticks (4 ms) ago. Interrupts
 * masked.
 */
uint32_t clock_extend(uint16_t captured);

#endif
