/* The table of all effects: the simulator, Python, the command line and the documents share it. */
#ifndef EFFECTS_TABLE_H
#define EFFECTS_TABLE_H

#include <stdint.h>

#include "effects/effect.h"

/* Number of rows. */
uint32_t sim_effect_count(void);

/* Row `index`, or NULL past the end. */
const sim_effect_t *sim_effect_at(uint32_t index);

#endif
