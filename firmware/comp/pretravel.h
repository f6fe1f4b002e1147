/*
 * Pretravel of a touch-trigger probe and the speeds that make it the same in every direction.
 * w = w_T + v·τ: the transducer's part depends on the direction, the delay's part on the speed.
 * Source: variable-speed compensation of trigger errors, equations (1) to (6); µm = mm/min·ms / 60.
 *
 * A direction i has a trigger radius r_i, which stands for its pretravel: it grows with the speed.
 * All functions: task level, pure; arrays are the caller's and are not kept.
 */
#ifndef COMP_PRETRAVEL_H
#define COMP_PRETRAVEL_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What all of comp/pretravel*.h return: PRETRAVEL_OK or a negative code. */
enum {
    PRETRAVEL_OK = 0,
    PRETRAVEL_ERR_NOT_FINITE = -1,     /* NaN or infinite where a number is wanted */
    PRETRAVEL_ERR_DIRECTION = -2,      /* an angle out of range */
    PRETRAVEL_ERR_FEW_DIRECTIONS = -3, /* too few for a map */
    PRETRAVEL_ERR_GAP = -4,            /* directions are missing from the map */
    PRETRAVEL_ERR_CAPACITY = -5,       /* the caller's array is too short */
    PRETRAVEL_ERR_FEW_RUNS = -6,       /* fewer than 3 runs: no uncertainty of the slope */
    PRETRAVEL_ERR_ONE_SPEED = -7,      /* all runs at one speed: no slope */
    PRETRAVEL_ERR_TAU = -8,            /* τ not above 0 */
    PRETRAVEL_ERR_SPEED = -9,          /* a given speed not above 0 */
    PRETRAVEL_ERR_TOO_SLOW = -10,      /* a compensated speed would have to be 0 or less */
    PRETRAVEL_ERR_TOO_FAST = -11,      /* … above the maximum */
    PRETRAVEL_ERR_OVERTRAVEL = -12,    /* … so that the overtravel allows it no more */
    PRETRAVEL_ERR_RAMP = -13,          /* … not reached within the approach */
    PRETRAVEL_ERR_LIMIT = -14,         /* a limit that is not above 0 */
    PRETRAVEL_ERR_FEW_POINTS = -15,    /* too few for the centre */
    PRETRAVEL_ERR_CENTRE = -16,        /* the points do not tell where the centre is */
    PRETRAVEL_ERR_SCALE = -17,         /* a speed does not fit the fixed-point table */
    PRETRAVEL_ERR_DIVISIONS = -18      /* no such division of that table */
};

/* A sentence for a code, in English, without a full stop. */
const char *pretravel_error(int code);

/* From which side the artefact is touched: the sign of pretravel in the measured radius. */
typedef enum {
    PRETRAVEL_INSIDE = 1,  /* ring: measured radius = ring − tip + pretravel */
    PRETRAVEL_OUTSIDE = -1 /* sphere: measured radius = sphere + tip − pretravel */
} pretravel_side_t;

/* The radius W that every direction shall get. */
typedef enum {
    PRETRAVEL_TARGET_MEAN = 0, /* of the map */
    PRETRAVEL_TARGET_MAX = 1,  /* nothing slows down */
    PRETRAVEL_TARGET_MIN = 2,  /* nothing speeds up */
    PRETRAVEL_TARGET_GIVEN = 3
} pretravel_target_t;

/* How to compensate, and what the machine can do. A limit of INFINITY is none. */
typedef struct {
    double             tau_ms; /* > 0 */
    pretravel_target_t target;
    double             target_um; /* W, for PRETRAVEL_TARGET_GIVEN only */
    double             speed_max_mm_min;
    double             overtravel_speed_mm_min; /* the speed whose overtravel is just allowed:
                                                   overtravel_safe_feed_mm_min() */
    double accel_mm_s2;
    double approach_mm; /* where the speed is set to the surface */
} pretravel_plan_t;

/* What a table came to; after a failure `where` is the first direction that caused it. */
typedef struct {
    double   target_um; /* W; give it back as PRETRAVEL_TARGET_GIVEN to hold it while iterating */
    uint32_t where;
} pretravel_result_t;

/* τ by least squares. The offset (artefact, tip, mean w_T) is what the line has at speed 0. */
typedef struct {
    double tau_ms;
    double tau_uncertainty_ms; /* standard, from the scatter about the line, runs − 2 degrees */
    double offset_um;          /* measured radius at speed 0 */
    double scatter_um;         /* of the runs about the line, standard deviation */
} pretravel_tau_t;

/* w = w_T + v·τ in µm. Equation (1). */
double pretravel_um(double transducer_um, double speed_mm_min, double tau_ms);

/* Pretravel from the radius measured on an artefact whose measured radius without pretravel would
   be `nominal_um` (ring − tip or sphere + tip). */
double pretravel_from_radius_um(double measured_um, double nominal_um, pretravel_side_t side);

/* V_r = max − min of the radii (n ≥ 1), in µm; NaN if one of them is. */
double pretravel_range_um(const double *radius_um, uint32_t n);

/*
 * τ as the slope of the mean trigger radius over the speed, from n runs.
 * Errors: NOT_FINITE, SPEED, FEW_RUNS, ONE_SPEED, TAU (no slope, or the side is wrong).
 */
int pretravel_estimate_tau(const double *speed_mm_min, const double *mean_radius_um, uint32_t n,
                           pretravel_side_t side, pretravel_tau_t *tau);

/*
 * v1 = v0 + (W − r)/τ for n directions, whose radii r were measured at the speeds v0. To iterate,
 * measure at v1 and call again with v0 := v1. `new_speed_mm_min` may be the array of v0. After an
 * error it is unchanged. Equation (3).
 * Errors: NOT_FINITE, TAU, LIMIT, SPEED, FEW_DIRECTIONS (n = 0), TOO_SLOW, TOO_FAST, OVERTRAVEL,
 * RAMP: the ramp v²/2a is as long as the approach, or longer.
 */
int pretravel_speed_table(const double *radius_um, const double *speed_mm_min, uint32_t n,
                          const pretravel_plan_t *plan, double *new_speed_mm_min,
                          pretravel_result_t *result);

/* Radii to be expected at new speeds: r + (v1 − v0)·τ. `predicted_um` may be `radius_um`. */
void pretravel_predict_um(const double *radius_um, const double *speed_mm_min,
                          const double *new_speed_mm_min, uint32_t n, double tau_ms,
                          double *predicted_um);

/*
 * Δt_R = Σ1/v1 / Σ1/v0 − 1: how much longer the approaches take, as a fraction; the approach is
 * equally long in all n ≥ 1 directions, the speeds above 0. Equation (6), v0 for each direction.
 */
double pretravel_time_increase(const double *speed_mm_min, const double *new_speed_mm_min,
                               uint32_t n);

/*
 * t_M = Σ S/v: time of n approaches of S = approach_mm each, in s; the speeds above 0. Equation
 * (5), and with n = 1 equation (4), t_s.
 */
double pretravel_time_s(const double *speed_mm_min, uint32_t n, double approach_mm);

#ifdef __cplusplus
}
#endif

#endif
