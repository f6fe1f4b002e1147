/*
 * The pins of the board, an ATmega328P at 16 MHz.
 *
 *   PB0 (ICP1, PCINT0)  trigger line            Timer0  steps of the axis
 *   PD2                 step pulse, out         Timer1  device clock and input capture
 *   PD3                 direction, out          Timer2  scans of the PLC task
 *   PD4                 software interrupt: driven, left open
 *   PD0, PD1            UART, 250 kBd, 8N1
 *
 * In the program main_transmission.c PB0 and PD2 (INT0) are the two pulse inputs.
 */
#ifndef ATMEGA328P_BOARD_H
#define ATMEGA328P_BOARD_H

#include <avr/io.h>

#define BOARD_CLOCK_HZ 16000000ul
#define BOARD_BUS_BAUD 250000ul

#define BOARD_TRIGGER_CHANNEL 0u
#define BOARD_TRIGGER_BIT     _BV(PB0)
#define BOARD_STEP_BIT        _BV(PD2)
#define BOARD_DIRECTION_BIT   _BV(PD3)
#define BOARD_DEFER_BIT       _BV(PD4)

#define BOARD_AXIS 0u

#endif
