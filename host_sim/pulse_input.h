/* Two pulse lines and what the port keeps of their edges until the firmware takes it. */
#ifndef SIM_PULSE_INPUT_H
#define SIM_PULSE_INPUT_H

#include <stdbool.h>
#include <stdint.h>

#include "hal_pulse.h"

#define SIM_PULSES_HELD 256u

/* Zero is: lines low, not watched. */
typedef struct {
    hal_pulse_t held[SIM_PULSES_HELD];
    uint32_t    noted; /* since the start, both modulo 2^32 */
    uint32_t    taken;
    uint8_t     lost; /* since the last one that was noted */
    bool        is_started;
    bool        notes_high; /* rising edges, else falling ones */
    bool        levels[HAL_PULSE_CHANNELS];
} sim_pulse_input_t;

/* The voltage of a line, from the instant on at which the device clock reads `ticks`. */
void sim_pulse_input_set(sim_pulse_input_t *input, uint8_t channel, bool high, uint32_t ticks);

/* hal_pulse.h, of this input. */
void sim_pulse_input_start(sim_pulse_input_t *input, hal_pulse_edge_t edge);
void sim_pulse_input_stop(sim_pulse_input_t *input);
bool sim_pulse_input_take(sim_pulse_input_t *input, hal_pulse_t *pulse);

#endif
