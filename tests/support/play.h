/* Playing touches through the whole chain, firmware and all, and looking at what came of them. */
#ifndef SUPPORT_PLAY_H
#define SUPPORT_PLAY_H

#include <stddef.h>
#include <stdint.h>

#include "api/batch.h"
#include "chain.h"

#define PLAY_SEED 20241u

/*
 * Rigs without any noise, on which every outcome can be foretold to the nanosecond: the tick is
 * 1 ns, a count 1 nm, a scan 4 ms.
 */
extern const sim_chain_t PLAY_BENCH;   /* edges injected at the connector */
extern const sim_chain_t PLAY_MACHINE; /* 100 µm of pretravel, 10 µs of delay */

/* One touch, nothing debounced. */
extern const sim_controller_t PLAY_ONE_TOUCH;

/* A touch number `touch` at that time: 1 mm at 600 mm/min. */
sim_touch_t play_touch(uint64_t touch, int32_t path, double time_s);

/* Play them once, without effects; the test fails if they are refused. */
void play(const sim_chain_t *chain, const sim_controller_t *controller, const sim_touch_t *touches,
          size_t n, sim_outcome_t *outcomes);

/* A time of an outcome in whole nanoseconds. */
int64_t play_ns(double us);

/* Fail unless each outcome is a touch that was latched and reported. */
void play_check_ok(const sim_outcome_t *outcomes, size_t n);

/* Fail unless both are the same to the last bit. */
void play_check_identical(const sim_outcome_t *expected, const sim_outcome_t *actual, size_t n);

#endif
