#include "perf/floor.h"

#include <math.h>

#include "probe.h"
#include "random.h"

#define UM_PER_MM  1000.0
#define US_PER_S   1.0e6
#define US_PER_MIN 60.0e6

/* Steps 1 to 3 of the nominal chain: from the start of the move to the pin. */
static double pin_us(const sim_chain_t *chain, const sim_touch_t *touch, sim_random_t *random,
                     double *contact_us, double *speed)
{
    double accel = chain->accel_mm_s2 * UM_PER_MM / (US_PER_S * US_PER_S);
    double approach_um = touch->approach_mm * UM_PER_MM;
    *speed = fmin(touch->feed_mm_min * UM_PER_MM / US_PER_MIN, sqrt(2.0 * accel * approach_um));
    *contact_us = touch->time_s * US_PER_S + approach_um / *speed + *speed / (2.0 * accel);
    sim_rest_t rest = {0}; /* calibrated lobes remember no push */
    double     pretravel_um = sim_probe_pretravel_um(chain, touch, &rest, random);
    return *contact_us + pretravel_um / *speed + chain->delay_us + chain->filter_us;
}

static double latch_us(const sim_chain_t *chain, int32_t path, double pin, double phase,
                       sim_random_t *random)
{
    if (path == SIM_PATH_PLC) {
        return phase + ceil((pin - phase) / chain->scan_us) * chain->scan_us;
    }
    return pin + chain->skip_latency_us + sim_random_uniform(random, chain->skip_jitter_us);
}

void floor_play(const sim_chain_t *chain, const sim_touch_t *touches, uint64_t n, uint64_t seed,
                sim_outcome_t *outcomes)
{
    sim_random_t random;
    sim_random_begin(&random, seed, 0u, UINT64_MAX, 0u);
    double phase = sim_random_uniform(&random, chain->scan_us);
    for (uint64_t i = 0; i < n; ++i) {
        double contact;
        double speed;
        sim_random_begin(&random, seed, 0u, touches[i].touch, 0u);
        double pin = pin_us(chain, &touches[i], &random, &contact, &speed);
        double latch = latch_us(chain, touches[i].path, pin, phase, &random);
        double report_jitter = sim_random_uniform(&random, chain->report_jitter_us);
        double deviation = speed * (latch - contact) / chain->resolution_um;
        outcomes[i] = (sim_outcome_t){
            .edge_us = NAN,
            .latch_us = floor(latch / chain->tick_us) * chain->tick_us,
            .report_us = latch + chain->report_latency_us + report_jitter,
            .deviation_um = rint(deviation) * chain->resolution_um,
            .true_edge_us = pin - chain->filter_us,
        };
    }
}
