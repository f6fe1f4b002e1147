/*
 * The pins and timers of grbl 1.1 on an ATmega328P at 16 MHz, those that matter here:
 *
 *   PC5 (A5, PCINT13)  probe                 Timer0  end of the step pulse
 *   PD2                step pulse of X, out  Timer1  step interrupt, clear on compare
 *   PD5                direction of X, out   Timer2  left to the spindle
 *   PD0, PD1           UART
 */
#ifndef ATMEGA328P_GRBL_BOARD_H
#define ATMEGA328P_GRBL_BOARD_H

#include <avr/io.h>

#define BOARD_CLOCK_HZ 16000000ul
#define BOARD_BUS_BAUD 250000ul

#define BOARD_PROBE_CHANNEL 0u
#define BOARD_PROBE_BIT     _BV(PC5)
#define BOARD_STEP_BIT      _BV(PD2)
#define BOARD_DIRECTION_BIT _BV(PD5)

#define BOARD_AXIS 0u

#endif
