/* The store of kinematics through operations at random that power cuts end, beside a model of it.
 */
#ifndef SOAK_STORE_CUTS_H
#define SOAK_STORE_CUTS_H

#include <stddef.h>

#include "cycle/kinematics_store.h"
#include "dice.h"

#define STORE_CUTS_NUMBERS 8u /* records that are saved, restored and deleted */

typedef struct {
    uint8_t            memory[KINEMATICS_STORE_BYTES];
    kinematics_store_t store;
    dice_t             dice;
    uint32_t           made; /* descriptions so far */
    uint64_t           operations;
    uint64_t           cuts;
} store_cuts_t;

/* An empty store, with a first description active. */
void store_cuts_start(store_cuts_t *rig, uint64_t seed);

/*
 * Begin an operation, cut the power at a byte at random or not at all, garble the page that was
 * being written, mount. NULL if what is found is what was or, without a cut, what shall be; else
 * what fell.
 */
const char *store_cuts_play(store_cuts_t *rig);

#endif
