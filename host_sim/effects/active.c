#include "effects/active.h"

#include <string.h>

#include "effects/table.h"

#define LANES 256u

/*
 * Lane 0 of the random numbers is the nominal chain's, and every row of the table has one of its
 * own: what an effect draws does not depend on which others are switched on. The same effect once
 * more takes a lane from the far end.
 */
static uint32_t lane_of(const sim_setting_t *settings, uint32_t i)
{
    bool is_repeated = i > 0u && settings[i].effect == settings[i - 1u].effect;
    return is_repeated ? LANES - i : 1u + (uint32_t)settings[i].effect;
}

static sim_quantity_t quantity_of(const sim_effect_t *effect, const double *parameters)
{
    for (uint32_t k = 0; effect->about.parameters[k].name != NULL; ++k) {
        bool is_switch = strcmp(effect->about.parameters[k].name, SIM_MOVES_SURFACE) == 0;
        if (is_switch && parameters[k] > 0.5) {
            return SIM_SURFACE;
        }
    }
    return effect->quantity;
}

void sim_effects_boot(sim_effects_t *effects, const sim_setting_t *settings, uint32_t count,
                      uint64_t seed, uint64_t replicate)
{
    *effects = (sim_effects_t){.count = count, .seed = seed, .replicate = replicate};
    for (uint32_t i = 0; i < count; ++i) {
        sim_active_t *active = &effects->active[i];
        active->effect = sim_effect_at((uint32_t)settings[i].effect);
        active->parameters = settings[i].parameters;
        active->lane = lane_of(settings, i);
        active->quantity = quantity_of(active->effect, active->parameters);
        effects->quantities |= 1u << active->quantity;
        sim_random_begin(&active->random, seed, replicate, UINT64_MAX, active->lane);
        active->rig = sim_random_uniform(&active->random, 1.0);
    }
}

static void begin(const sim_effects_t *effects, sim_active_t *active, uint64_t number)
{
    sim_random_begin(&active->random, effects->seed, effects->replicate, number, active->lane);
}

void sim_effects_begin_touch(sim_effects_t *effects, uint64_t touch)
{
    for (uint32_t i = 0; i < effects->count; ++i) {
        begin(effects, &effects->active[i], touch);
    }
}

/* An effect changes one quantity: what draws by scan never draws by touch, so one lane does. */
void sim_effects_begin_scan(sim_effects_t *effects, uint64_t scan)
{
    for (uint32_t i = 0; i < effects->count; ++i) {
        if (effects->active[i].quantity == SIM_SCAN_START) {
            begin(effects, &effects->active[i], scan);
        }
    }
}

static double sum_us(const sim_active_t *active)
{
    double sum = 0.0;
    for (uint32_t k = 0; active->effect->about.parameters[k].name != NULL; ++k) {
        bool is_time = strcmp(active->effect->about.parameters[k].unit, "µs") == 0;
        sum += is_time ? active->parameters[k] : 0.0;
    }
    return sum;
}

double sim_effects_most_us(const sim_effects_t *effects, sim_quantity_t quantity)
{
    double most_us = 0.0;
    for (uint32_t i = 0; i < effects->count; ++i) {
        const sim_active_t *active = &effects->active[i];
        most_us += active->quantity == quantity ? sum_us(active) : 0.0;
    }
    return SIM_RANDOM_FARTHEST * most_us;
}

double sim_effects_change(sim_effects_t *effects, const sim_effect_call_t *scene,
                          sim_quantity_t quantity, double value)
{
    for (uint32_t i = 0; i < effects->count; ++i) {
        sim_active_t *active = &effects->active[i];
        if (active->quantity == quantity) {
            sim_effect_call_t call = *scene;
            call.parameters = active->parameters;
            call.state = active->state;
            call.random = &active->random;
            call.rig = active->rig;
            value = active->effect->change(&call, value);
        }
    }
    return value;
}
