/*
 * Probe stage: where along the approach the probe triggers. On a bench there is no probe: the
 * contact closes at the nominal surface (step 2 of the nominal chain). The chain says what the
 * probe is: calibrated lobes, or the mechanics of a seat.
 */
#ifndef SIM_PROBE_H
#define SIM_PROBE_H

#include "chain.h"
#include "random.h"
#include "seat.h"

/*
 * What of a pretravel in µm the chain admits: all of it, or nothing below 0.
 */
double sim_probe_admitted_um(const sim_chain_t *chain, double pretravel_um);

/*
 * Pretravel in µm of one approach in the direction of `touch`, as far as it is admitted:
 * w = pretravel + lobe·cos β·cos 3(α − phase) + N(0, repeatability), or with a seat, what that
 * makes of the direction and of the push before, which `rest` remembers, + N(0, repeatability).
 * 0 on a bench.
 */
double sim_probe_pretravel_um(const sim_chain_t *chain, const sim_touch_t *touch, sim_rest_t *rest,
                              sim_random_t *random);

#endif
