/*
 * The firmware's transmission error for blocks of pulses, as in files: time in 64-bit nanoseconds.
 * Python reads this header too: no more of the preprocessor than what can be left out.
 */
#ifndef API_TRAINS_H
#define API_TRAINS_H

#include <stdint.h>

#include "comp/transmission.h"

#pragma GCC visibility push(default)

enum {
    SIM_TRAINS_OK = 0,
    SIM_TRAINS_ERR_CHANNEL = -1, /* a pulse of no channel */
    SIM_TRAINS_ERR_ORDER = -2,   /* a pulse before the one before */
    SIM_TRAINS_ERR_TICK = -6     /* tick_ns of 0; beside the codes of transmission_error_t */
};

typedef struct {
    int64_t t_ns; /* when the gating train's line passed */
    int64_t line; /* its number */
    int64_t delta_nas;
} sim_trains_point_t;

/* Owned by the caller; goes on from block to block. */
typedef struct {
    transmission_t core;
    uint32_t       tick_ns;
    int64_t        last_ns;  /* of any pulse */
    int64_t        dense_ns; /* of the last pulse of the denser train; INT64_MIN: none */
    int64_t        line;     /* of the last point */
    uint64_t       pulses;   /* taken in */
} sim_trains_t;

/* SIM_TRAINS_OK, SIM_TRAINS_ERR_TICK or a code of transmission_error_t. */
int sim_trains_begin(sim_trains_t *trains, const transmission_config_t *config, uint32_t tick_ns);

/*
 * Take in n pulses; write at most n + TRANSMISSION_PENDING points and their number. A code of this
 * header other than SIM_TRAINS_OK means that pulse number trains->pulses (over all blocks) is at
 * fault, and the ones before it have been taken in.
 */
int sim_trains_feed(sim_trains_t *trains, const uint8_t *channels, const int64_t *t_ns, uint64_t n,
                    sim_trains_point_t *points, uint64_t *points_count);

/* What was found so far; channel TRANSMISSION_INPUT or TRANSMISSION_OUTPUT. */
pulse_counters_t     sim_trains_counters(const sim_trains_t *trains, uint8_t channel);
transmission_index_t sim_trains_index(const sim_trains_t *trains, uint8_t channel);

#pragma GCC visibility pop

#endif
