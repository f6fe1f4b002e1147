/*
 * Cycles 451, 452 and 453 of the firmware on a five-axis machine: what a controller does around it.
 * Every request of the cycle is carried out here, but for those that the caller answers: evaluate,
 * acknowledge, apply, clear. Python reads this header too: no more of the preprocessor than what
 * can be left out.
 */
#ifndef API_FIVE_AXIS_CYCLE_H
#define API_FIVE_AXIS_CYCLE_H

#include <stdint.h>

#include "api/sim_station.h"
#include "chain.h"
#include "five_axis.h"

#pragma GCC visibility push(default)

typedef struct sim_measure_kinematics sim_measure_kinematics_t;

/* How the controller is set up, and where the operator has left the machine. */
typedef struct {
    double  hirth_deg[3];  /* grid of A, B, C; 0: none */
    double  tip_radius_mm; /* as calibrated */
    double  set_up_mm;
    double  probe_feed_max_mm_min;
    double  rapid_mm_min;
    double  tool_feed_mm_min;
    double  global_feed_mm_min;
    double  global_clearance_mm;
    double  max_modification_mm;
    double  max_dev_cal_ball_mm;
    double  start_deg[3];      /* rotary axes at the start */
    double  preset_miss_mm[3]; /* the operator's preset is so far off the sphere's centre */
    double  start_above_mm;    /* the tip stands so far above the top of the sphere */
    double  touch_feed_mm_min;
    double  search_mm;           /* a touch goes on so far past the nominal surface */
    int32_t strobe_rot_ax_pos;   /* number of the M function that positions; -1: none */
    int32_t has_kinematics_opt;  /* option 48 */
    int32_t has_kinematics_comp; /* option 52 */
    int32_t has_advanced_functions_2;
    int32_t is_tcpm_on;
    int32_t is_turning; /* FUNCTION MODE TURN */
    int32_t track;      /* TRACK of the probe table: the spindle turns the probe to each touch */
    int32_t path;       /* SIM_PATH_* of every touch */
} sim_control_t;

/* Why sim_measure_kinematics_run() came back. */
enum {
    SIM_451_EVALUATE = 0,
    SIM_451_ACKNOWLEDGE = 1,
    SIM_451_APPLY = 2,
    SIM_451_DONE = 3,
    SIM_451_FAILED = 4,
    SIM_451_CLEAR = 5
};

/* What the cycle has done so far. */
typedef struct {
    double  preset_mm[3];
    double  change_mm;  /* that waits for its acknowledgement */
    double  duration_s; /* motions at their feeds, and touches; no ring calibration */
    int64_t touches;
    int32_t error;       /* kinematics_cycle_error_t */
    int32_t parameter;   /* at fault: 406 for Q406; 0: none */
    int32_t touch_error; /* touch_error_t of the last touch */
    int32_t cancelled_rotation;
    int32_t presets;
    int32_t is_tilted; /* 3-D ROT of the automatic mode, at tilt_deg of A, B, C */
    double  tilt_deg[3];
} sim_measure_kinematics_report_t;

/*
 * Switch on a machine that is as `truth` and is believed to be as `believed`, the errors of which
 * are not looked at. Returns SIM_PLAY_OK, or the SIM_PLAY_ERR_… of what cannot be played and NULL
 * in `opened`. What it is given is copied.
 */
int  sim_measure_kinematics_open(const sim_rig_t *rig, const sim_machine_t *truth,
                                 const sim_machine_t *believed, const sim_control_t *control,
                                 sim_measure_kinematics_t **opened);
void sim_measure_kinematics_close(sim_measure_kinematics_t *play);

/*
 * Make it cycle 452, before any parameter is set: the preset is not the operator's of today, but
 * was set in a sphere that is believed to stand at `sphere_mm` at zero.
 */
void sim_measure_kinematics_keep_preset(sim_measure_kinematics_t *play, const double sphere_mm[3]);

/* Make it cycle 453, before any parameter is set, over the grid of what is believed. */
void sim_measure_kinematics_measure_grid(sim_measure_kinematics_t *play);

/*
 * Set Q<id> to a number, or with `word` (kinematics_word_t, not 0) to a word. Returns
 * kinematics_setting_error_t; sim_measure_kinematics_phrase() says it in words.
 */
int         sim_measure_kinematics_set(sim_measure_kinematics_t *play, uint16_t id, double value,
                                       int32_t word);
const char *sim_measure_kinematics_phrase(int setting_error);

/* A phrase for sim_measure_kinematics_report_t.error. */
const char *sim_measure_kinematics_fault_phrase(int error);

/* Limits of Q<id>, its default and its name; NULL if cycle `number` has no such parameter. */
const char *sim_measure_kinematics_limits(int32_t number, uint16_t id, double *low, double *high,
                                          double *initial);

/* Start the cycle (once), and run until it comes back for something. */
int sim_measure_kinematics_run(sim_measure_kinematics_t *play);

/*
 * Start the cycle (once) with what was measured elsewhere: it obeys the same rules, and comes back
 * for the evaluation without a motion. At most as many stations as a cycle has.
 */
int sim_measure_kinematics_run_measured(sim_measure_kinematics_t *play,
                                        const sim_station_t *stations, uint32_t n);

/* Answer what the cycle came back for, and run on. */
int sim_measure_kinematics_answer(sim_measure_kinematics_t *play, double change_mm,
                                  int32_t is_possible);

/* From now on the controller believes this of its axes. */
void sim_measure_kinematics_believe(sim_measure_kinematics_t *play, const sim_machine_t *believed);

/*
 * What a sphere that stands at `sphere_mm` at zero should read at these angles of A, B, C, by
 * firmware/comp.
 */
void sim_machine_expect(const sim_machine_t *believed, const double sphere_mm[3],
                        const double angle_deg[3], double reading_mm[3]);

/* What the table of cycle 453 adds to that. */
void sim_machine_compensation(const sim_machine_t *believed, const double angle_deg[3],
                              double offset_mm[3]);

/* Write up to `capacity` measurements, and return how many there are. */
uint32_t sim_measure_kinematics_stations(const sim_measure_kinematics_t *play,
                                         sim_station_t *stations, uint32_t capacity);
void     sim_measure_kinematics_report(const sim_measure_kinematics_t  *play,
                                       sim_measure_kinematics_report_t *report);

#pragma GCC visibility pop

#endif
