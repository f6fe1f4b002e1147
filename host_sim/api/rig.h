/*
 * A simulated rig with the real firmware in it: the controller's wiring (what a port's main.c is
 * elsewhere), and the recorder at the other end of the bus.
 */
#ifndef API_RIG_H
#define API_RIG_H

#include "chain.h"
#include "cycle/touch_cycle.h"
#include "input/plc_task.h"
#include "input/skip_input.h"
#include "report/latch_frame.h"
#include "report/latch_report.h"
#include "sim.h"

enum { RIG_ERR_CLOCK = -100 }; /* beside HAL_ERR_*: the device clock all but stops, or races */

typedef struct {
    sim_t                   sim;
    const sim_controller_t *controller;
    skip_input_t            skip;
    plc_task_t              plc;
    touch_cycle_t           cycle;
    latch_report_t          report;
    latch_decoder_t         decoder; /* the recorder's */
    int                     path;    /* SIM_PATH_* that runs, or -1 */
    sim_ns_t                done_at; /* end of the last whole cycle */
} rig_t;

/*
 * Switch on at `now`; see sim_boot(). `controller` has to outlive the rig, which has to stay in
 * place.
 */
void rig_boot(rig_t *rig, const sim_chain_t *chain, const sim_controller_t *controller,
              const sim_setting_t *settings, uint32_t count, uint64_t seed, uint64_t replicate,
              sim_ns_t now);

/*
 * Play one touch from the start of its measuring move to the end of the cycle. A touch that begins
 * before the end of the one before is played as if that had not been. Binds the HAL of this thread.
 * Returns HAL_OK, the error of the input that could not be started, or RIG_ERR_CLOCK.
 */
int rig_play(rig_t *rig, const sim_touch_t *touch, sim_outcome_t *outcome);

#endif
