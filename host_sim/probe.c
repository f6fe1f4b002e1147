#include "probe.h"

#include <math.h>

#include "angle.h"

#define LOBES 3.0

static double lobed_um(const sim_chain_t *chain, const sim_touch_t *touch)
{
    double azimuth = LOBES * (touch->alpha_deg - chain->lobe_phase_deg) * RAD_PER_DEG;
    double lobe = chain->lobe_um * cos(touch->beta_deg * RAD_PER_DEG) * cos(azimuth);
    return chain->pretravel_um + lobe;
}

static double seated_um(const sim_seat_t *seat, const sim_touch_t *touch, sim_rest_t *rest)
{
    double reseat_um = sim_seat_reseat_um(seat, rest, touch->alpha_deg, touch->beta_deg);
    return sim_seat_pretravel_um(seat, touch->alpha_deg, touch->beta_deg) + reseat_um;
}

double sim_probe_admitted_um(const sim_chain_t *chain, double pretravel_um)
{
    return chain->is_signed ? pretravel_um : fmax(0.0, pretravel_um);
}

double sim_probe_pretravel_um(const sim_chain_t *chain, const sim_touch_t *touch, sim_rest_t *rest,
                              sim_random_t *random)
{
    if (!chain->is_machine) {
        return 0.0;
    }
    double systematic_um =
        sim_has_seat(chain) ? seated_um(&chain->seat, touch, rest) : lobed_um(chain, touch);
    double noise_um = sim_random_normal(random, chain->repeatability_um);
    return sim_probe_admitted_um(chain, systematic_um + noise_um);
}
