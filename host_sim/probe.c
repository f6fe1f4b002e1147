#include "probe.h"

#include <math.h>

#include "angle.h"

#define LOBES 3.0

double sim_probe_pretravel_um(const sim_chain_t *chain, const sim_touch_t *touch,
                              sim_random_t *random)
{
    if (!chain->is_machine) {
        return 0.0;
    }
    double azimuth = LOBES * (touch->alpha_deg - chain->lobe_phase_deg) * RAD_PER_DEG;
    double lobe = chain->lobe_um * cos(touch->beta_deg * RAD_PER_DEG) * cos(azimuth);
    double noise = sim_random_normal(random, chain->repeatability_um);
    return fmax(0.0, chain->pretravel_um + lobe + noise);
}
