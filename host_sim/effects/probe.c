/* Effects in the probe. */
#include <math.h>

#include "angle.h"
#include "effects/effect.h"

#define LOBES 3.0

double effect_pretravel_lobing(const sim_effect_call_t *call, double pretravel_um)
{
    double azimuth = LOBES * (call->touch->alpha_deg - call->parameters[1]) * RAD_PER_DEG;
    double tilt = call->touch->beta_deg * RAD_PER_DEG;
    return pretravel_um + call->parameters[0] * cos(tilt) * cos(azimuth);
}
