/* The PLC's scan period: Timer 3, reloaded by hardware, so a late scan moves no later one. */
#ifndef ATMEGA2560_SCAN_H
#define ATMEGA2560_SCAN_H

#include <stdint.h>

/* From now on scan_on_period() comes every `period_us`, 1 to 32768. Task. */
void scan_start(uint16_t period_us);

/* No scan after the return. Task. */
void scan_stop(void);

/* main.c: one scan of the PLC. Interrupt. */
void scan_on_period(void);

#endif
