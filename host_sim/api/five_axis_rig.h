/*
 * A five-axis machine with the real firmware in it: every touch is a touch of the rig, latched
 * through the skip or the PLC path, on the surface that the machine's true geometry puts in the
 * way.
 */
#ifndef API_FIVE_AXIS_RIG_H
#define API_FIVE_AXIS_RIG_H

#include <stdbool.h>
#include <stdint.h>

#include "api/rig.h"
#include "five_axis.h"
#include "random.h"

typedef struct {
    rig_t                rig;
    const sim_machine_t *machine;
    sim_controller_t     controller; /* its overtravel is that of the present touch */
    sim_stance_t         stance;
    sim_random_t         random;
    sim_touch_t          touch;         /* the last one */
    double               calibrated_mm; /* contact to latch, mean; taken off every touch */
    double               cycle_s;       /* of the last touch, back at its start */
    int32_t              error;         /* touch_error_t of the last touch */
    bool                 is_tracking;   /* a controlled spindle turns the probe to every touch */
    bool                 is_broken;     /* the firmware refused to start its input */
} five_axis_rig_t;

/* How a machine touches. */
typedef struct {
    double  feed_mm_min;
    int32_t path; /* SIM_PATH_* */
    bool    is_tracking;
} five_axis_touching_t;

/* SIM_PLAY_OK, or the code of what cannot be played: machine, believed machine, chain … */
int five_axis_check(const sim_machine_t *machine, const sim_machine_t *believed,
                    const sim_rig_t *setup);

/*
 * Switch on at the home position and calibrate the probe by touches of its own, all round.
 * `machine` and the chain of `setup` have to outlive it, and it has to stay in place.
 */
void five_axis_boot(five_axis_rig_t *rig, const sim_machine_t *machine, const sim_rig_t *setup,
                    five_axis_touching_t touching);

/* Turn one rotary axis, SIM_ROTARY_*; it takes its time. */
void five_axis_turn(five_axis_rig_t *rig, int32_t axis, double command_deg);

/*
 * Probe from `start_mm` along the unit vector `direction`, at most `travel_mm` far. Gives the
 * reading of the linear axes at which the ball touched. False without a touch: none in the way, or
 * the probe is deflected at the start.
 */
bool five_axis_touch(five_axis_rig_t *rig, const double start_mm[3], const double direction[3],
                     double travel_mm, double touched_mm[3]);

#endif
