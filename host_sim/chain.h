/*
 * The parameters of a simulated rig. The names, units and meaning are those of a campaign's
 * nominal.toml; Python reads this header, so it holds plain declarations only.
 */
#ifndef SIM_CHAIN_H
#define SIM_CHAIN_H

#include <stdint.h>

/*
 * A probe with a three-contact seat, by its mechanics; beta_deg is then 0 to 90. See seat.h. What
 * it does to the pretravel takes the place of the calibrated mean and its lobes.
 */
typedef struct {
    double spring_n;    /* force of the seat's spring; 0: no such seat, the lobes count */
    double seat_mm;     /* from the stylus axis to the edge that the seat tilts about */
    double stylus_mm;   /* stylus length, seat to the centre of the tip */
    double stem_n_m2;   /* flexural rigidity of the stylus, E·I */
    double axial_um_n;  /* compliance along the stylus axis */
    double evenness;    /* 0: three sharp contacts; 1: the same force all round */
    double azimuth_deg; /* a direction of least force; the others at ±120° */
    double reseat_um;   /* by how much the tip rests off centre, where it was pushed last */
} sim_seat_t;

/* The nominal chain: what the engineer believes of the rig. */
typedef struct {
    double  pretravel_um;
    double  lobe_um;
    double  lobe_phase_deg;
    double  repeatability_um;
    double  delay_us;
    double  filter_us;
    double  skip_latency_us;
    double  skip_jitter_us;
    double  tick_us;
    double  scan_us;
    double  resolution_um;
    double  accel_mm_s2;
    double  report_latency_us;
    double  report_jitter_us;
    double  reference_jitter_us;
    int32_t is_machine; /* 1: a probe touches a surface; 0: edges injected on a bench */
    int32_t is_signed;  /* 1: a pretravel may be below 0, where the place of the surface has some
                         * of it; 0: none is */
    sim_seat_t seat;    /* not of nominal.toml: what the engineer knows nothing of */
} sim_chain_t;

/* How the controller is set up: the firmware's cycle and the motion behind it. */
typedef struct {
    double  overtravel_mm;    /* how far past the nominal surface the probe may be driven */
    double  back_off_mm;      /* two touches: from the first latch back */
    double  fast_feed_mm_min; /* two touches: of the first touch, back-off and return */
    double  reaction_us;     /* stop request to the start of the deceleration: task, motion queue */
    double  confirm_us;      /* debounce: the level rests this long to confirm a touch */
    double  holdoff_us;      /* bounces within this time belong to the touch */
    double  settle_us;       /* the release may come this long after the end of a retreat */
    double  scan_phase_us;   /* PLC: a time at which a scan begins; 0: anywhere in each run */
    double  scan_spread_us;  /* PLC: with a phase, by up to so much later, drawn for each run */
    double  start_spread_us; /* PLC: by up to so much the move of a touch begins later */
    int32_t two_touches;     /* 0 or 1 */
    int32_t image_delay_scans; /* PLC: age of the input image */
    int32_t every_scan;        /* 1: execute also the scans in which nothing can happen */
} sim_controller_t;

enum { SIM_PATH_SKIP = 0, SIM_PATH_PLC = 1 };
enum { SIM_AXIS_X = 0, SIM_AXIS_Y = 1, SIM_AXIS_Z = 2 };

enum { SIM_FURTHER_THERMOMETERS = 4 };

/* The conditions of one touch: a row of a campaign. */
typedef struct {
    double   time_s;      /* start of the measuring move */
    double   feed_mm_min; /* of the measuring touch */
    double   approach_mm; /* from the start of the move to the surface */
    double   alpha_deg;
    double   beta_deg;
    double   pulse_us;    /* the contact opens again after this long; 0: when the axis retreats */
    double   sign;        /* 1 or -1: the sense in which the axis moves */
    double   position_mm; /* axis coordinate of the nominal surface */
    double   rotary_deg;
    double   datum_um;   /* how far past the nominal surface the axis shows the real one */
    double   surface_um; /* how far past it that one lies; the axis goes on at its speed there */
    double   temp_c;
    double   further_temp_c[SIM_FURTHER_THERMOMETERS]; /* of thermometers at other places */
    uint64_t touch; /* serial number; with seed and replicate it picks the random numbers */
    int32_t  path;  /* SIM_PATH_* */
    int32_t  axis;  /* that mostly moves: SIM_AXIS_* */
} sim_touch_t;

/* A position further off is told as this: sums of two, as the firmware makes, fit 32 bits. */
enum { SIM_COUNTS_MAX = 0x3FFFFFFF };

enum { SIM_STATUS_OK = 0, SIM_STATUS_MISSED = 1 };

enum { SIM_PARAMETERS = 13 }; /* the most that an effect has */

/* One effect that is switched on: a row of effects/table.c, and its parameters in that order. */
typedef struct {
    double  parameters[SIM_PARAMETERS];
    int32_t effect;
} sim_setting_t;

/* A rig that is switched on: what it is, and which random numbers it has. */
typedef struct {
    const sim_chain_t      *chain;
    const sim_controller_t *controller;
    const sim_setting_t    *settings; /* effects, in the order of the table */
    uint32_t                settings_count;
    uint64_t                seed;
    uint64_t                replicate; /* the first one where there are several; below 2^32 */
} sim_rig_t;

/* What came of one touch. What was not recorded is NaN. */
typedef struct {
    double  edge_us;        /* the reference instrument's; bench only */
    double  latch_us;       /* the firmware's time stamp, device clock */
    double  report_us;      /* arrival of the report */
    double  deviation_um;   /* latched minus nominal position along the approach */
    double  overtravel_um;  /* latch to standstill, measuring touch */
    double  cycle_s;        /* the whole cycle, back at the start */
    double  true_edge_us;   /* when the contact really closed at the connector */
    double  start_delay_us; /* by which the move began later than it was to */
    int32_t status;         /* SIM_STATUS_* */
    int32_t error;          /* touch_error_t of the firmware's cycle */
} sim_outcome_t;

#endif
