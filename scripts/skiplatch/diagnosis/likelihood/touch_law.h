/* The law of one touch in one stream, once the physics is changed. */
#ifndef DIAGNOSIS_TOUCH_LAW_H
#define DIAGNOSIS_TOUCH_LAW_H

#include "diagnosis/likelihood/physics.h"

/* Share of a fine step by which a value may miss its grid for want of digits. */
#define ROUNDING 0.01

/* Give the law of touch i, by that under the nominal chain; its slack left out. */
sim_law_t touch_law(const sim_touches_t *of, uint32_t stream, const sim_law_t *chain,
                    const sim_change_t *change, uint64_t i);

/* Give extra k of touch i, in the unit of the stream. */
sim_extra_t touch_extra(const sim_touches_t *of, uint32_t stream, const sim_change_t *change,
                        uint32_t k, uint64_t i);

#endif
