/*
 * The transmission error of a chain whose encoders are on the two pulse inputs of the board
 * (hal_pulse.h), channel 0 at the input shaft and channel 1 at the output: takes the pulses in the
 * task and hands them to comp/transmission.
 *
 * Where the port has lost pulses nobody knows how far the shafts have turned meanwhile, so nothing
 * is counted across such a gap: a new part begins, with lines and delta from 0 again.
 */
#ifndef TRANSMISSION_PULSE_INTAKE_H
#define TRANSMISSION_PULSE_INTAKE_H

#include <stdbool.h>
#include <stdint.h>

#include "comp/transmission.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Owned by the caller; `core` may be read. Task only. */
typedef struct {
    transmission_t core;
    uint32_t       dense_ticks; /* of the last pulse of the denser train */
    uint32_t       lost;        /* pulses that the port says it has lost, since the beginning */
    uint32_t       parts;       /* gaps so far: which part this is, from 0 */
    bool           is_backward;
    bool           is_unsure; /* a turn has failed: the lines may not be watched at all */
} pulse_intake_t;

/*
 * Before first use, and before hal_pulse_start(HAL_PULSE_RISING). TRANSMISSION_OK or a code of
 * transmission_error_t, and then *intake is not to be used.
 */
int pulse_intake_init(pulse_intake_t *intake, const transmission_config_t *config);

/*
 * The shafts are about to turn backward, or forward as at the beginning: for pulses taken from now
 * on, so when they have come to rest and the last pulse has been taken. A train has no sense of its
 * own; whoever moves the shafts has. Backward falling edges are stamped, for they are those of the
 * flanks that rise forward: with others the width of the marks would count as backlash. Returns
 * HAL_OK, or what hal_pulse_start() says of the other edge; then nothing has turned, no pulse may
 * come, and a further call, of either sense, tries again.
 */
int pulse_intake_turn(pulse_intake_t *intake, bool is_backward);

/*
 * Take one pulse if there is one. Returns how many points it has brought: transmission_point() of
 * `core`, until the next call. As often as you can; 2^30 ticks may not pass without a call.
 */
uint8_t pulse_intake_poll(pulse_intake_t *intake);

#ifdef __cplusplus
}
#endif

#endif
