/*
 * The HAL of the simulated rig: the functions of hal/include, reading the rig that this thread
 * plays.
 */
#ifndef SIM_PORT_H
#define SIM_PORT_H

#include "pulse_input.h"
#include "sim.h"

/* From now on the HAL of this thread is `sim`. */
void sim_port_bind(sim_t *sim);

/* And its pulse inputs are these; without them the rig has none. */
void sim_port_bind_pulses(sim_pulse_input_t *input);

#endif
