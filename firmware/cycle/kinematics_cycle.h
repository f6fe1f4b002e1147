/*
 * Cycle 451, MEASURE KINEMATICS, as a polled state machine: probes a calibration sphere at several
 * positions of each rotary axis, has the kinematics evaluated and, if told so, corrected. Also
 * cycle 452, PRESET COMPENSATION, by the kind of the settings: the preset was set in the sphere
 * before a head was changed or the machine drifted. The preset stays, and the kinematics are
 * corrected so that the sphere stands there again. And cycle 453, KINEMATICS GRID: the sphere is
 * probed over a grid of the rotary axes that the machine's maker has set, and how far it is off at
 * each position, against that with all axes at 0°, goes into a table (comp/kinematics_grid.h).
 *
 * The cycle asks for one thing after the other, and the caller carries it out: kinematics_cycle_
 * start(), then poll with the outcome of the request taken last, and take the next request, until
 * the state is KINEMATICS_CYCLE_DONE or KINEMATICS_CYCLE_FAILED. There is never more than one
 * request on its way. Moving, and latching a touch with a touch_cycle, is the caller's work.
 *
 * Positions are readings of the three linear axes in mm, in machine coordinates, with the centre of
 * the probe's tip in the point meant; so a centre of the sphere is what the linear axes read when
 * the tip is concentric with it, on a table and on a head alike. Angles are readings of the rotary
 * axes in degrees, in the order A, B, C; axes that the machine has not stand at 0. An inch program
 * changes nothing here: all lengths are mm.
 */
#ifndef CYCLE_KINEMATICS_CYCLE_H
#define CYCLE_KINEMATICS_CYCLE_H

#include <stdbool.h>
#include <stdint.h>

#include "cycle/kinematics_conditions.h"
#include "cycle/kinematics_plan.h"
#include "cycle/kinematics_settings.h"
#include "cycle/kinematics_stance.h"
#include "cycle/sphere_probe.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum {
    KINEMATICS_CYCLE_IDLE,
    KINEMATICS_CYCLE_RUNNING,
    KINEMATICS_CYCLE_DONE,
    KINEMATICS_CYCLE_FAILED /* the machine stops where it is; kinematics_cycle_fault_t says why */
} kinematics_cycle_state_t;

typedef enum {
    /* Delete SPA, SPB and SPC of the active preset: no basic rotation, 2-D or 3-D. */
    KINEMATICS_CYCLE_CANCEL_ROTATION,
    /* Spindle axis to retract_height_mm in the untilted workpiece system, then the other two linear
     * axes to the preset. The probe is not watched. */
    KINEMATICS_CYCLE_RETRACT,
    /* Turn `axis` alone to angle_deg[axis]; `follow`: the tip goes along with the sphere, as the
     * active kinematics believe it goes, stand_off_mm from its centre along the tool axis. Not
     * watched. Answer: centre_mm and tool_axis at angle_deg, see there. */
    KINEMATICS_CYCLE_TURN,
    /* The same, turned by `m_function`. */
    KINEMATICS_CYCLE_TURN_BY_M_FUNCTION,
    /* All linear axes at once, straight, to target_mm. The probe is watched. */
    KINEMATICS_CYCLE_MOVE,
    /* One touch of touch_cycle: from target_mm (where the tip stands) along `direction`; nominal
     * surface after stand_off_mm, and back to target_mm. Answer: touched_mm. */
    KINEMATICS_CYCLE_TOUCH,
    /* The active preset becomes sphere_mm, read with the rotary axes at angle_deg. */
    KINEMATICS_CYCLE_SET_PRESET,
    /* Fit kinematics to the measurements, see kinematics_cycle_plan(), as Q406 says; in cycle 452
     * with the sphere in the preset; in cycle 453 tell how far it is off at each station. Answer:
     * change_mm. Nothing is changed yet. */
    KINEMATICS_CYCLE_EVALUATE,
    /* Show a warning: change_mm is above maxModification. Carried out once NC start is pressed. */
    KINEMATICS_CYCLE_ACKNOWLEDGE,
    /* Write the evaluated kinematics into the active description, or cycle 453's table. */
    KINEMATICS_CYCLE_APPLY,
    /* Cycle 453 in mode −1, and nothing else then: all values of the table become 0. */
    KINEMATICS_CYCLE_CLEAR,
    /* Last of all: the working plane of the automatic mode (3-D ROT) becomes active, as the rotary
     * axes stand, angle_deg. */
    KINEMATICS_CYCLE_TILT
} kinematics_cycle_request_kind_t;

typedef struct {
    kinematics_cycle_request_kind_t kind;
    rotary_axis_t                   axis;                        /* that turns */
    double                          angle_deg[ROTARY_AXES];      /* all axes, after turning */
    double                          from_angle_deg[ROTARY_AXES]; /* TURN: sphere_mm holds here */
    double                          sphere_mm[LINEAR_AXES];      /* its centre: TURN, SET_PRESET */
    double                          target_mm[LINEAR_AXES];      /* MOVE, TOUCH */
    double                          direction[LINEAR_AXES];      /* TOUCH, length 1 */
    double                          stand_off_mm;                /* TURN, TOUCH */
    double                          retract_height_mm;           /* RETRACT */
    double                          change_mm;                   /* ACKNOWLEDGE */
    double                          feed_mm_min;                 /* of motions; deg/min alike */
    int32_t                         m_function;                  /* TURN_BY_M_FUNCTION */
    bool                            follow;                      /* TURN */
} kinematics_cycle_request_t;

typedef enum {
    KINEMATICS_CYCLE_BUSY,        /* with the request; the rest of the input does not matter */
    KINEMATICS_CYCLE_CARRIED_OUT, /* the answer is here; also the outcome of the first poll */
    KINEMATICS_CYCLE_IMPOSSIBLE   /* no touch, a collision, a limit switch, or an operator's "no" */
} kinematics_cycle_outcome_t;

/* What the cycle has to know at each poll; what was not asked for is not looked at. */
typedef struct {
    kinematics_cycle_outcome_t outcome;
    double                     touched_mm[LINEAR_AXES]; /* TOUCH: the latched position */
    /* TURN: where the active kinematics expect the centre at request.angle_deg, when it was in
     * sphere_mm at from_angle_deg. */
    double centre_mm[LINEAR_AXES];
    double tool_axis[LINEAR_AXES]; /* TURN: from tip to spindle, length 1 */
    double change_mm; /* EVALUATE: the largest change of the location of an axis, or in a table */
} kinematics_cycle_input_t;

/* What the cycle is at: what the request on its way belongs to. */
typedef enum {
    KINEMATICS_STEP_CANCEL_ROTATION,
    KINEMATICS_STEP_SEARCH, /* Q431 = 1 or 3: roughly where the sphere is, then exactly */
    KINEMATICS_STEP_LOCATE,
    KINEMATICS_STEP_PRESET_BEFORE,
    KINEMATICS_STEP_LEAVE, /* to the retract height, or above the sphere */
    KINEMATICS_STEP_TURN,
    KINEMATICS_STEP_MEASURE,
    KINEMATICS_STEP_WITHDRAW, /* as LEAVE, after the last station */
    KINEMATICS_STEP_EVALUATE,
    KINEMATICS_STEP_ACKNOWLEDGE,
    KINEMATICS_STEP_APPLY,
    KINEMATICS_STEP_CLEAR,
    KINEMATICS_STEP_PRESET_AFTER,
    KINEMATICS_STEP_TILT
} kinematics_cycle_step_t;

/* Owned by the caller; the fields are for this module. Start from all zeros. */
typedef struct {
    kinematics_job_t           job;
    kinematics_plan_t          plan;
    sphere_probe_t             probe;
    kinematics_cycle_request_t request;
    kinematics_cycle_fault_t   fault;
    kinematics_cycle_state_t   state;
    kinematics_cycle_step_t    step;
    kinematics_stance_t        stance;
    double                     tool_axis[LINEAR_AXES];
    double                     expected_mm[LINEAR_AXES]; /* the centre, at the stance */
    double                     sphere_mm[LINEAR_AXES];   /* as measured last, at sphere_deg */
    double                     sphere_deg[ROTARY_AXES];
    double                     contact_mm; /* sphere and tip as measured last */
    double                     change_mm;
    bool                       is_located; /* the sphere, where the axes still stand */
    bool                       has_request;
} kinematics_cycle_t;

/*
 * Begin a cycle. Task. KINEMATICS_CYCLE_OK, or the error that also stands in the fault; nothing
 * moves then.
 */
kinematics_cycle_error_t kinematics_cycle_start(kinematics_cycle_t               *cycle,
                                                const kinematics_settings_t      *settings,
                                                const kinematics_cycle_machine_t *machine);

/*
 * The same for what was measured before, `count` stations: nothing moves or is touched, and the
 * cycle asks at once for the evaluation. A radius that is off by more than maxDevCalBall is an
 * error as in a cycle that measures; KINEMATICS_CYCLE_ERR_NOTHING for no station or more than
 * KINEMATICS_STATIONS_MAX. Not for mode −1 of cycle 453, which measures nothing. Task.
 */
kinematics_cycle_error_t kinematics_cycle_start_measured(kinematics_cycle_t               *cycle,
                                                         const kinematics_settings_t      *settings,
                                                         const kinematics_cycle_machine_t *machine,
                                                         const kinematics_station_t       *stations,
                                                         uint8_t                           count);

/* One step. Task. */
kinematics_cycle_state_t kinematics_cycle_poll(kinematics_cycle_t             *cycle,
                                               const kinematics_cycle_input_t *input);

/* Take what to do now. False if there is nothing. Task. */
bool kinematics_cycle_take_request(kinematics_cycle_t *cycle, kinematics_cycle_request_t *request);

/* KINEMATICS_CYCLE_OK unless the state is KINEMATICS_CYCLE_FAILED. Task. */
const kinematics_cycle_fault_t *kinematics_cycle_fault(const kinematics_cycle_t *cycle);

/* The stations, and what was measured there up to now. Task. */
const kinematics_plan_t *kinematics_cycle_plan(const kinematics_cycle_t *cycle);

#ifdef __cplusplus
}
#endif

#endif
