/* Effects of the optical or radio link between probe and receiver. */
#include <math.h>

#include "angle.h"
#include "effects/effect.h"

#define MOST_AGAIN 0.95 /* so that a trigger arrives */

double effect_link_slotting(const sim_effect_call_t *call, double sent_us)
{
    double slot_us = call->parameters[0];
    double first_us = effect_origin(call, call->parameters[1] / DEG_PER_TURN) * slot_us;
    return first_us + ceil((sent_us - first_us) / slot_us) * slot_us;
}

/* Where every attempt fails with the same probability, the number of retries is geometric; after
 * one that failed the next may fail more often, for what disturbs a link lasts. */
double effect_link_retry(const sim_effect_call_t *call, double sent_us)
{
    double arrival_us = sent_us;
    double probability = call->parameters[0];
    double again = fmin(probability + call->parameters[3], MOST_AGAIN);
    while (sim_random_uniform(call->random, 1.0) < probability) {
        probability = again;
        arrival_us +=
            fmax(0.0, call->parameters[1] + sim_random_normal(call->random, call->parameters[2]));
    }
    return arrival_us;
}
