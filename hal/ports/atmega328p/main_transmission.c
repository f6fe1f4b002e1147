/*
 * A second program for the ATmega328P: measures the transmission error of a drive chain by
 * subdivided counting, from encoders on PD2 (input) and PB0 (output), and sends each point over the
 * UART (transmission/point_frame.h). A byte on the UART says what to do:
 *
 *   m  measure, from the beginning          f  the shafts are about to turn forward
 *   n  watch nothing                        b  the same, backward
 *   t  send the tally
 */
#include <avr/interrupt.h>
#include <stdbool.h>
#include <stdint.h>

#include "clock.h"
#include "hal_bus.h"
#include "hal_pulse.h"
#include "transmission/point_frame.h"
#include "transmission/pulse_intake.h"
#include "uart_bus.h"

static const transmission_config_t CHAIN = {
    .method = TRANSMISSION_SUBDIVIDED,
    .lines1 = 1024u,
    .lines2 = 3600u,
    .ratio_over = 407u,
    .ratio_under = 10u,
    .meter_ticks = 1u,
};

static pulse_intake_t intake;

/* Points for which the bus had no room, since the start; wraps. A rig reads it. */
volatile uint16_t transmission_unsent;

static void send_tally(void)
{
    uint8_t frame[HAL_BUS_FRAME_BYTES];
    point_frame_of_tally(frame, &intake);
    (void)hal_bus_send(frame); /* asked for once more if there is no room */
}

static void measure(void)
{
    hal_pulse_stop();
    (void)pulse_intake_init(&intake, &CHAIN); /* has worked at the start */
    (void)hal_pulse_start(HAL_PULSE_RISING);
}

static void obey(uint8_t command)
{
    switch (command) {
    case 'm':
        measure();
        break;
    case 'f':
        (void)pulse_intake_turn(&intake, false);
        break;
    case 'b':
        (void)pulse_intake_turn(&intake, true);
        break;
    case 't':
        send_tally();
        break;
    default:
        hal_pulse_stop();
        break;
    }
}

/* Points have to give way to pulses: without room on the bus they are dropped, and counted. */
static void send_points(uint8_t count)
{
    for (uint8_t i = 0u; i < count; ++i) {
        transmission_point_t point = transmission_point(&intake.core, i);
        uint8_t              frame[HAL_BUS_FRAME_BYTES];
        point_frame_of_point(frame, intake.parts, &point);
        if (hal_bus_send(frame) != 0) {
            ++transmission_unsent;
        }
    }
}

int main(void)
{
    clock_start();
    bus_start();
    bool is_good = pulse_intake_init(&intake, &CHAIN) == TRANSMISSION_OK;
    sei();
    while (is_good) {
        uint8_t command;
        if (bus_take_byte(&command)) {
            obey(command);
        }
        send_points(pulse_intake_poll(&intake));
    }
    return 1; /* the table above is wrong */
}
