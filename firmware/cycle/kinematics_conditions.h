/*
 * What has to be so before cycle 451, 452 or 453 moves anything, and what its settings come to on a
 * machine: feeds, clearance, retract height. Lengths in mm, feeds in mm/min, angles in degrees.
 */
#ifndef CYCLE_KINEMATICS_CONDITIONS_H
#define CYCLE_KINEMATICS_CONDITIONS_H

#include <stdbool.h>
#include <stdint.h>

#include "cycle/kinematics_plan.h"
#include "cycle/kinematics_settings.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Up to NOTHING nothing has moved when the error comes. */
typedef enum {
    KINEMATICS_CYCLE_OK,
    KINEMATICS_CYCLE_ERR_SETTING,      /* out of its limits: see kinematics_settings_check() */
    KINEMATICS_CYCLE_ERR_NO_FEED,      /* the control has no feed for the word of Q253 */
    KINEMATICS_CYCLE_ERR_NO_CLEARANCE, /* Q320 and SET_UP are 0: a touch would begin touching */
    KINEMATICS_CYCLE_ERR_NO_CYCLE,     /* no KinematicsOpt (option 48): no cycle at all */
    KINEMATICS_CYCLE_ERR_OPTION,       /* Q406 = 2 or 3 without KinematicsComp (option 52) */
    KINEMATICS_CYCLE_ERR_NOT_STACKED,  /* Q406 = 3 needs one rotary axis upon another */
    KINEMATICS_CYCLE_ERR_RETRACT,      /* Q408 = 0 with a Hirth axis that turns, or no option 2 */
    KINEMATICS_CYCLE_ERR_TCPM,         /* M128 or TCPM is on */
    KINEMATICS_CYCLE_ERR_TURNING,      /* the cycle is one of FUNCTION MODE MILL */
    KINEMATICS_CYCLE_ERR_NOT_AT_ZERO,  /* an M function positions, and a rotary axis is not at 0° */
    KINEMATICS_CYCLE_ERR_MACHINE,   /* a value of kinematics_cycle_machine_t is out of its range */
    KINEMATICS_CYCLE_ERR_INCIDENCE, /* 452: an axis that it leaves alone is told to turn */
    KINEMATICS_CYCLE_ERR_NO_COMP,   /* 453 without KinematicsComp (option 52) */
    KINEMATICS_CYCLE_ERR_GRID,      /* 453: the machine has no sound grid that its axes can take */
    KINEMATICS_CYCLE_ERR_NOTHING,   /* no axis that is there has a position to measure */
    KINEMATICS_CYCLE_ERR_REQUEST,   /* the caller could not carry out what it was asked for */
    KINEMATICS_CYCLE_ERR_NO_SPHERE, /* no sphere passes through the touched points */
    KINEMATICS_CYCLE_ERR_BALL_RADIUS, /* off Q407 by more than maxDevCalBall */
    KINEMATICS_CYCLE_ERR_REFUSED      /* a change above maxModification was not acknowledged */
} kinematics_cycle_error_t;

typedef struct {
    kinematics_cycle_error_t error;
    kinematics_setting_t     parameter; /* at fault, KINEMATICS_SETTINGS if none is */
} kinematics_cycle_fault_t;

typedef struct {
    kinematics_plan_axis_t axes[ROTARY_AXES];
    double                 angle_deg[ROTARY_AXES];   /* at the start of the cycle */
    double                 position_mm[LINEAR_AXES]; /* the same */
    double                 preset_mm[LINEAR_AXES]; /* the tip in the active preset, at angle_deg */
    double                 tool_axis[LINEAR_AXES]; /* from tip to spindle, length 1 */
    double                 tip_radius_mm;          /* the calibrated tip, ≥ 0 */
    double                 set_up_mm; /* SET_UP of the probe table; Q320 comes on top; ≥ 0 */
    double                 probe_feed_max_mm_min; /* FMAX of the probe table, > 0 */
    double                 rapid_mm_min;          /* Q253 FMAX */
    double                 tool_feed_mm_min;      /* Q253 FAUTO */
    double                 global_feed_mm_min;    /* Q253 PREDEF */
    double                 global_clearance_mm;   /* Q320 PREDEF, ≥ 0 */
    double                 max_modification_mm;   /* 204801, ≥ 0 */
    double                 max_dev_cal_ball_mm;   /* 204802, ≥ 0; 0: the radius is not watched */
    int32_t                strobe_rot_ax_pos;     /* 204803: M function that positions; -1: none */
    bool                   has_kinematics_opt;    /* option 48 */
    bool                   has_kinematics_comp;   /* option 52 */
    bool                   has_advanced_functions_2; /* option 2 */
    bool                   is_tcpm_on;
    bool                   is_turning; /* FUNCTION MODE TURN is active */
    bool                   is_stacked; /* two rotary axes, both in the table or both in the head */
    kinematics_grid_t      grid;       /* of cycle 453; no nodes at all: the machine has none */
} kinematics_cycle_machine_t;

/* Q406 and Q431. */
enum {
    KINEMATICS_MODE_DELETE = -1, /* the table of cycle 453 */
    KINEMATICS_MODE_CHECK,
    KINEMATICS_MODE_POSITIONS, /* in cycle 453: compensate */
    KINEMATICS_MODE_ANGLES,
    KINEMATICS_MODE_DATUM
};
enum {
    KINEMATICS_PRESET_NEVER,
    KINEMATICS_PRESET_BEFORE,
    KINEMATICS_PRESET_AFTER,
    KINEMATICS_PRESET_BEFORE_AND_AFTER
};

/* One cycle on one machine. */
typedef struct {
    kinematics_settings_t      settings;
    kinematics_cycle_machine_t machine;
} kinematics_job_t;

/* Check all, and make the plan. Any context. */
kinematics_cycle_fault_t kinematics_conditions_check(const kinematics_job_t *job,
                                                     kinematics_plan_t      *plan);

/* A whole number among the settings, once they are checked, and Q406, which may be below 0. Any
 * context. */
uint8_t kinematics_conditions_whole(const kinematics_job_t *job, kinematics_setting_t setting);
int8_t  kinematics_conditions_mode(const kinematics_job_t *job);

/* Feed while the probe is not watched, respectively is: then its own limit counts as well. Q253 = 0
 * names none: the probe's own. */
double kinematics_conditions_feed(const kinematics_job_t *job);
double kinematics_conditions_watched_feed(const kinematics_job_t *job);

/* Q320 and SET_UP, and the radii of sphere and tip. */
double kinematics_conditions_stand_off(const kinematics_job_t *job);
double kinematics_conditions_contact(const kinematics_job_t *job);

bool kinematics_conditions_has_retract_height(const kinematics_job_t *job);
bool kinematics_conditions_has_m_function(const kinematics_job_t *job);

/* Q431: whether the preset is set in the sphere before measuring, respectively after. */
bool kinematics_conditions_presets_before(const kinematics_job_t *job);
bool kinematics_conditions_presets_after(const kinematics_job_t *job);

/* Whether what was touched, radii of sphere and tip, is the sphere of Q407, as far as that is
 * watched. */
bool kinematics_conditions_is_the_sphere(const kinematics_job_t *job, double contact_mm);

/* A phrase like "the axes would not move". Any context. */
const char *kinematics_cycle_phrase(kinematics_cycle_error_t error);

#ifdef __cplusplus
}
#endif

#endif
