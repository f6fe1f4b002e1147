/* The floor of the benchmark: the nominal chain as a bare loop, no firmware, no events. */
#ifndef PERF_FLOOR_H
#define PERF_FLOOR_H

#include <stdint.h>

#include "chain.h"

#pragma GCC visibility push(default)

/*
 * Draw the numbers that the simulation draws and do its arithmetic, for one replicate of n
 * touches.
 */
void floor_play(const sim_chain_t *chain, const sim_touch_t *touches, uint64_t n, uint64_t seed,
                sim_outcome_t *outcomes);

#pragma GCC visibility pop

#endif
