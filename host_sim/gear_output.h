/*
 * Where the output of a gear train stands: the flanks of its gears, the twist of the train and the
 * thread of its screw. What the sources of the gear train share is here, too; only they use it.
 */
#ifndef SIM_GEAR_OUTPUT_H
#define SIM_GEAR_OUTPUT_H

#include "gear_train.h"

#define GEAR_UM_PER_MM 1000.0
#define GEAR_PPM       1e-6

/* Where a position or a time is looked for: rounds at most, and how close is close enough. */
#define GEAR_ROUNDS 60
#define GEAR_CLOSE  4e-16 /* of a position, and of a turn */

/* What is drawn at random, each from a lane of its own. */
#define GEAR_LANE_JITTER 0u
#define GEAR_LANE_PITCH  1u

/* A sine a turn. */
double sim_gear_sine(double turns, double phase_deg);

/* Of the pitch circle of one of the two gears of a stage. */
double sim_gear_circumference_um(const sim_gear_stage_t *stage, const sim_gear_t *gear);

/* Turns of the output, leads with a screw, when the driving flank has made so many of the input. */
double sim_gear_output_turns(const sim_gear_run_t *run, double driving_turns);

#endif
