/*
 * The HAL of the simulated rig: the functions of hal/include, reading the rig that this thread
 * plays.
 */
#ifndef SIM_PORT_H
#define SIM_PORT_H

#include "sim.h"

/* From now on the HAL of this thread is `sim`. */
void sim_port_bind(sim_t *sim);

#endif
