/* What there is to say of an effect. Python reads this header too: plain declarations only. */
#ifndef EFFECTS_DESCRIPTION_H
#define EFFECTS_DESCRIPTION_H

#include "chain.h"

typedef struct {
    const char *name; /* with its unit */
    const char *unit;
    const char *meaning;
    double      low; /* the range that makes sense */
    double      high;
} sim_parameter_t;

typedef struct {
    const char     *id;      /* part of the product's interface */
    const char     *stage;   /* motion, probe, link, input, latch, scan, position, report */
    const char     *paths;   /* both, skip or plc */
    const char     *physics; /* one line */
    sim_parameter_t parameters[SIM_PARAMETERS + 1]; /* ended by one without a name */
} sim_description_t;

#endif
