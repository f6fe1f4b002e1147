/*
 * The simulation as a shared library: plays whole campaigns through the firmware, on several
 * threads. Python reads this header too: no more of the preprocessor than what can be left out.
 */
#ifndef API_BATCH_H
#define API_BATCH_H

#include <stdint.h>

#include "chain.h"
#include "effects/description.h"

#pragma GCC visibility push(default)

enum {
    SIM_PLAY_OK = 0,
    SIM_PLAY_ERR_CHAIN = -1,   /* a value of the chain is not finite or out of range */
    SIM_PLAY_ERR_CONTROL = -2, /* the same of the controller */
    SIM_PLAY_ERR_TOUCH = -3,   /* the same of a touch */
    SIM_PLAY_ERR_START = -4,   /* the firmware refused to start the input */
    SIM_PLAY_ERR_MEMORY = -5,
    SIM_PLAY_ERR_EFFECT = -6, /* an effect that is not in the table, too many, or a bad parameter */
    SIM_PLAY_ERR_MACHINE = -7, /* a five-axis machine, see sim_machine_is_sound() */
    SIM_PLAY_ERR_CLOCK = -8    /* an effect all but stops the device clock, or doubles its rate */
};

/*
 * Play `touches` (n) on `rig`, `replicates` times, and write outcomes[replicate][touch]. Touches
 * may come in any order, unless an effect or a seat remembers the touch before: then in that of
 * time. The result depends on the arguments only, not on `threads` (≥ 1). Returns SIM_PLAY_OK or a
 * negative code; then nothing is to be read.
 */
int sim_play(const sim_rig_t *rig, const sim_touch_t *touches, uint64_t n, uint64_t replicates,
             uint32_t threads, sim_outcome_t *outcomes);

/* The part of its check that is not of the touches: SIM_PLAY_OK, or what cannot be played. */
int sim_play_check(const sim_rig_t *rig);

/* Row `index` of the table of effects, or NULL past the end. */
const sim_description_t *sim_effect_describe(uint32_t index);

/* A sentence for a code of sim_play(). */
const char *sim_play_error(int code);

#pragma GCC visibility pop

#endif
