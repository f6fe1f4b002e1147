/* The effects that are switched on in one simulated rig, any number of them in any combination. */
#ifndef EFFECTS_ACTIVE_H
#define EFFECTS_ACTIVE_H

#include <stdbool.h>
#include <stdint.h>

#include "effects/effect.h"

enum { SIM_EFFECTS_MAX = 8 };

typedef struct {
    const sim_effect_t *effect;
    sim_quantity_t      quantity; /* that it changes here */
    const double       *parameters;
    double              state[SIM_STATES];
    double              rig;
    uint32_t            lane; /* of its random numbers */
    sim_random_t        random;
} sim_active_t;

typedef struct {
    sim_active_t active[SIM_EFFECTS_MAX];
    uint32_t     count;
    uint32_t     quantities; /* a bit for each sim_quantity_t that one of them changes */
    uint64_t     seed;
    uint64_t     replicate;
} sim_effects_t;

/*
 * Switch `count` ≤ SIM_EFFECTS_MAX effects on. The settings have to outlive them, and to be in the
 * order of the table.
 */
void sim_effects_boot(sim_effects_t *effects, const sim_setting_t *settings, uint32_t count,
                      uint64_t seed, uint64_t replicate);

/* Begin the random numbers of a touch. */
void sim_effects_begin_touch(sim_effects_t *effects, uint64_t touch);

/* Begin those of a scan. */
void sim_effects_begin_scan(sim_effects_t *effects, uint64_t scan);

static inline bool sim_effects_reach(const sim_effects_t *effects, sim_quantity_t quantity)
{
    return (effects->quantities >> quantity & 1u) != 0u;
}

/*
 * The most in µs that the effects can add to a quantity, if each adds no more than the sum of its
 * parameters in µs, as the means of draws from exponential laws: what is asked of those of scans.
 */
double sim_effects_most_us(const sim_effects_t *effects, sim_quantity_t quantity);

/*
 * What the effects make of a quantity. Of `scene`, what belongs to one effect (parameters, state,
 * random, rig) is filled in here.
 */
double sim_effects_change(sim_effects_t *effects, const sim_effect_call_t *scene,
                          sim_quantity_t quantity, double value);

#endif
