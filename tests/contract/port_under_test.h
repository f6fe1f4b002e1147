/*
 * What a port has to offer for the suites of this folder to run on it: its stimuli and its ears,
 * and a few facts about the board. One implementation is linked per port: tests/port_under_test.c
 * of its folder. A later port adds a file of its own and touches no suite.
 *
 * hal_edge_on_latch() is implemented by tests/support/edge_log.c.
 */
#ifndef CONTRACT_PORT_UNDER_TEST_H
#define CONTRACT_PORT_UNDER_TEST_H

#include <stdbool.h>
#include <stdint.h>

#include "hal_bus.h"

typedef struct {
    uint8_t  channels;         /* trigger lines: 0 … channels − 1, at least one */
    uint8_t  axes;             /* 0 … axes − 1, at least one */
    bool     has_active_low;   /* lines can be inverted */
    uint16_t filter_max_us;    /* the longest glitch filter, 0 if there is none */
    uint16_t filter_tried_us;  /* the filter that the suite tries: well above time_error_us */
    uint32_t edge_latency_us;  /* edge to hal_edge_on_latch(), at most; the captured time as well */
    uint32_t frame_latency_us; /* hal_bus_send() to the recorder, at most */
    uint32_t time_error_us;    /* by how much port_pass_us() may be off */
} port_facts_t;

extern const port_facts_t PORT;

/* As after power-on: lines low, nothing armed, axes at 0, bus empty. */
void port_power_up(void);

/* The same with the clock just at `ticks`. False if the port cannot; then it is powered up anyhow.
 */
bool port_power_up_at(uint32_t ticks);

/* Let time pass; interrupts that fall due run. Not inside a critical section. */
void port_pass_us(uint32_t us);

/* Set the voltage of a line, now: behind that come filter and polarity. */
void port_set_line(uint8_t channel, bool high);

/* Put an axis somewhere, at rest. */
void port_place_axis(uint8_t axis, int32_t position_counts);

/* Take the next frame that has arrived at the recorder. False if there is none. */
bool port_receive(uint8_t frame[HAL_BUS_FRAME_BYTES]);

#endif
