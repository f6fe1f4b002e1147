#include "effects/active.h"

#include "effects/table.h"

/* Lane 0 of the random numbers is the nominal chain's; every effect has two of its own. */
static uint32_t touch_lane(uint32_t index)
{
    return 1u + 2u * index;
}

static uint32_t scan_lane(uint32_t index)
{
    return 2u + 2u * index;
}

void sim_effects_boot(sim_effects_t *effects, const sim_setting_t *settings, uint32_t count,
                      uint64_t seed, uint64_t replicate)
{
    *effects = (sim_effects_t){.count = count, .seed = seed, .replicate = replicate};
    for (uint32_t i = 0; i < count; ++i) {
        sim_active_t *active = &effects->active[i];
        active->effect = sim_effect_at((uint32_t)settings[i].effect);
        active->parameters = settings[i].parameters;
        effects->quantities |= 1u << active->effect->quantity;
        sim_random_begin(&active->random, seed, replicate, UINT64_MAX, touch_lane(i));
        active->rig = sim_random_uniform(&active->random, 1.0);
    }
}

void sim_effects_begin_touch(sim_effects_t *effects, uint64_t touch)
{
    for (uint32_t i = 0; i < effects->count; ++i) {
        sim_random_begin(&effects->active[i].random, effects->seed, effects->replicate, touch,
                         touch_lane(i));
    }
}

void sim_effects_begin_scan(sim_effects_t *effects, uint64_t scan)
{
    for (uint32_t i = 0; i < effects->count; ++i) {
        if (effects->active[i].effect->quantity == SIM_SCAN_START) {
            sim_random_begin(&effects->active[i].random, effects->seed, effects->replicate, scan,
                             scan_lane(i));
        }
    }
}

double sim_effects_change(sim_effects_t *effects, const sim_effect_call_t *scene,
                          sim_quantity_t quantity, double value)
{
    for (uint32_t i = 0; i < effects->count; ++i) {
        sim_active_t *active = &effects->active[i];
        if (active->effect->quantity == quantity) {
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
