/*
 * What a port with pulse inputs has to offer for test_hal_pulse.c: the two lines, time, and a few
 * facts. One implementation is linked per port, hal/ports/PORT/tests/pulse_lines.c.
 */
#ifndef CONTRACT_PULSE_LINES_UNDER_TEST_H
#define CONTRACT_PULSE_LINES_UNDER_TEST_H

#include <stdbool.h>
#include <stdint.h>

typedef struct {
    uint32_t latency_us; /* from pulse_line_set() until the pulse can be taken, at most; the
                            captured time lies between the two */
    uint32_t spacing_us; /* pulses so far apart are all noted */
    uint32_t held_most;  /* pulses that the port can keep, at most: more than so many in a row,
                            with nobody to take them, are not all handed out */
} pulse_facts_t;

extern const pulse_facts_t PULSES;

/* As after power-on, both lines low, nothing watched, the clock just at `ticks`. */
void pulse_lines_power_up(uint32_t ticks);

/* The voltage of a line, now. */
void pulse_line_set(uint8_t channel, bool high);

/* Let time pass; interrupts that fall due run. */
void pulse_lines_pass_us(uint32_t us);

#endif
