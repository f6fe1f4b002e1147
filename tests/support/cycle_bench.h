/*
 * A touch cycle on the desk: the test moves the clock, the axis and the trigger line by hand.
 * The clock counts microseconds; taking a motion to begin sets the axis in motion.
 */
#ifndef SUPPORT_CYCLE_BENCH_H
#define SUPPORT_CYCLE_BENCH_H

#include <stdbool.h>
#include <stdint.h>

#include "cycle/touch_cycle.h"

#define BENCH_TICK_PS 1000000u

/* One rig for all tests: where things are, in counts, and how long they may take, in µs. */
#define BENCH_START     (-2000)
#define BENCH_APPROACH  5000
#define BENCH_BEYOND    2000
#define BENCH_SURFACE   (BENCH_START + BENCH_APPROACH)
#define BENCH_END       (BENCH_SURFACE + BENCH_BEYOND)
#define BENCH_BACK_OFF  300
#define BENCH_TIMEOUT   900000u
#define BENCH_SETTLE    5000u
#define BENCH_HOLDOFF   1000u
#define BENCH_UNDER_WAY 20000u
#define BENCH_FAST      3000.0
#define BENCH_SLOW      30.0

/* Without confirmation. */
extern const touch_config_t BENCH_ONE_TOUCH;
extern const touch_config_t BENCH_TWO_TOUCHES;

typedef struct {
    touch_cycle_t cycle;
    latch_t       latch;
    touch_input_t input;
    bool          is_deflected;
} cycle_bench_t;

/* Everything new: a cycle that never ran, an axis at rest at `position_counts`. */
void bench_set_up(cycle_bench_t *bench, uint32_t now_ticks, int32_t position_counts);

/* The same at BENCH_START, and a cycle under way. */
void bench_set_going(cycle_bench_t *bench, uint32_t now_ticks, const touch_config_t *config);

touch_error_t bench_start(cycle_bench_t *bench, const touch_config_t *config);

/* Poll the input and then the cycle. */
touch_state_t bench_poll(cycle_bench_t *bench);

void bench_pass(cycle_bench_t *bench, uint32_t ticks);

/* The probe is deflected now, with the axis at `position_counts`; nothing is polled. */
void bench_touch(cycle_bench_t *bench, int32_t position_counts);

void bench_release(cycle_bench_t *bench);

/* The same, and everything is polled. */
void bench_release_and_poll(cycle_bench_t *bench);

/* The axis comes to rest at `position_counts`; then everything is polled. */
touch_state_t bench_rest(cycle_bench_t *bench, int32_t position_counts);

/* Fail unless the cycle asks for this; the axis does it. */
void bench_check_move(cycle_bench_t *bench, int32_t target_counts, double feed_mm_min);
void bench_check_stop(cycle_bench_t *bench);
void bench_check_no_request(cycle_bench_t *bench);

/* Fail unless the cycle has failed with `error` and asks the axis to stop, or for nothing. */
void bench_check_failed(cycle_bench_t *bench, touch_error_t error, bool stops);

/* Take whatever motion is asked for. */
void bench_carry_out(cycle_bench_t *bench);

/* Touch the surface a while later: stopping. */
void bench_touch_surface(cycle_bench_t *bench);

/* Touch it, stop, and go back for BENCH_UNDER_WAY, still deflected. */
void bench_retreat(cycle_bench_t *bench);

#endif
