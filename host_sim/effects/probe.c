/* Effects in the probe. */
#include <math.h>

#include "angle.h"
#include "effects/effect.h"

#define LOBES 3.0

/* What three contacts add is even and periodic in the lobe: cosines of it and of its multiples. */
double effect_pretravel_lobing(const sim_effect_call_t *call, double pretravel_um)
{
    double lobe = LOBES * (call->touch->alpha_deg - call->parameters[1]) * RAD_PER_DEG;
    double tilt = call->touch->beta_deg * RAD_PER_DEG;
    double along_um = call->parameters[0] * cos(lobe) + call->parameters[2] * cos(2.0 * lobe) +
                      call->parameters[3] * cos(3.0 * lobe);
    return pretravel_um + along_um * pow(fabs(cos(tilt)), 1.0 + call->parameters[4]);
}
