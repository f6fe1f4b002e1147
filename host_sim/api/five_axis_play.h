/* A cycle that is being played: what the sources of five_axis_cycle.h share. Only they use it. */
#ifndef API_FIVE_AXIS_PLAY_H
#define API_FIVE_AXIS_PLAY_H

#include <stdbool.h>
#include <stdint.h>

#include "api/five_axis_belief.h"
#include "api/five_axis_cycle.h"
#include "api/five_axis_rig.h"
#include "cycle/kinematics_cycle.h"

struct sim_measure_kinematics {
    five_axis_rig_t          rig;
    sim_machine_t            truth;
    five_axis_belief_t       belief;
    sim_chain_t              chain;
    sim_control_t            control;
    kinematics_settings_t    settings;
    kinematics_cycle_t       cycle;
    kinematics_cycle_input_t input;
    double                   position_mm[3];
    double                   preset_mm[3];
    double                   shown_deg[3]; /* what the control shows */
    double                   change_mm;
    double                   tilt_deg[3];
    int32_t                  presets;
    int64_t                  touches;
    double                   duration_s; /* of the motions as programmed, and of the touches */
    bool                     is_started;
    bool                     is_tilted;
    bool                     is_rotation_cancelled;
};

static inline void five_axis_copy(double to[3], const double from[3])
{
    for (int i = 0; i < 3; ++i) {
        to[i] = from[i];
    }
}

/* `from` + `by` · direction. */
static inline void five_axis_ahead(const double from[3], const double direction[3], double by,
                                   double to[3])
{
    for (int i = 0; i < 3; ++i) {
        to[i] = from[i] + by * direction[i];
    }
}

#endif
