/*
 * What is known of touches, and what differs from the rig that is believed in: all that their laws
 * are made of. Times in µs, lengths in µm, speeds in µm/µs. Python reads this header too.
 */
#ifndef DIAGNOSIS_PHYSICS_H
#define DIAGNOSIS_PHYSICS_H

#include <stdint.h>

#include "diagnosis/density/law.h"

/* What can be seen of a touch; of the lattice, the grid of the scans, by all stamps together. */
enum sim_stream {
    SIM_MOTION,
    SIM_LATCH_SKIP,
    SIM_LATCH_PLC,
    SIM_LATTICE,
    SIM_POSITION,
    SIM_ARRIVAL, /* the position beside the arrival of a report, which stands for a stamp */
    SIM_DEVIATION_SKIP,
    SIM_DEVIATION_PLC,
    SIM_REPORT,
    SIM_STREAM_COUNT
};

/* A number for each touch, or one for all of them. */
typedef struct {
    const double *each; /* n; NULL for one */
    double        all;
} sim_number_t;

/* What a share of the touches gets on top of a law: see sim_extra_t. */
typedef struct {
    double       share;
    sim_number_t offset;
    sim_number_t width;
    sim_number_t mean;
    sim_number_t sigma;
    sim_number_t boxless;
} sim_some_t;

/* The physics that differs from the chain. */
typedef struct {
    sim_number_t contact_us;  /* later contact */
    sim_number_t surface_um;  /* by which the surface lies farther */
    sim_number_t speed_ratio; /* of the real to the believed speed at the contact, > 0 */
    sim_number_t pretravel_um;
    sim_number_t pin_us; /* later at the pin */
    sim_number_t skip_us;
    sim_number_t plc_us;
    sim_number_t stamp_us; /* added to the stamp alone */
    sim_number_t position_um;
    sim_number_t position_us; /* the way in which, at the real speed, is added to that */
    sim_number_t position_sigma_us;
    sim_number_t line_um; /* deviation at a line of the coarse position; NaN if not known */
    sim_number_t report_us;
    double       scan_us;   /* period of the scan, once it is changed */
    double       coarse_um; /* resolution of the position, if coarser than believed */
    double       coarse_us; /* tick of the skip path's stamps, if coarser than believed */
    double       tick_line_us;
    double       slot_us; /* of the slots in which alone triggers arrive; 0 if there are none */
    double       slot_phase_us;
    double       unlocked; /* share of touches whose scans keep a grid, of those bound to them */
    uint32_t     is_bound; /* scans are bound to touches, but for those */
    double       slack; /* scatter that a shift brings along, as a share of its root mean square */
    const sim_some_t *extras[SIM_STREAM_COUNT]; /* by stream; of a deviation in µs */
    uint32_t          extra_counts[SIM_STREAM_COUNT];
} sim_change_t;

/* What was recorded of one stretch of the chain; arrays of n. */
typedef struct {
    const double    *residuals;
    const sim_law_t *chain;    /* law under the nominal chain */
    const double    *believed; /* offset of the law of the rig that is believed in */
    const uint8_t   *known;    /* whether there is anything; the others hold any number */
} sim_recorded_t;

/* Touches, and what the nominal chain says of them; arrays of n. */
typedef struct {
    uint64_t        n;
    const double   *speed;
    const double   *pretravel_um;
    const double   *wait_us;  /* from the mechanical trigger to the earliest latch */
    const double   *begin_us; /* what the latch is counted from */
    const double   *latch_us; /* NaN if there is no stamp */
    const double   *deviation_um;
    const uint8_t  *is_plc;
    const uint32_t *groups; /* number of the datum of each, from 0 up */
    const double   *datum_senses; /* what a µm of datum adds along the approach, 1 or -1 */
    double          least_pretravel_um;
    double          resolution; /* scatter that is not resolved, in any unit, > 0 */
    double          tick_us;
    double          stamp_step_us; /* what stamps are rounded to: such ticks, or less */
    double          jitter_us; /* of the interrupt */
    double          scan_us;
    double          resolution_um;
    double          behind_us;   /* from the pin to the earliest latch on the skip path */
    double          datum_u_um;  /* standard uncertainty of a datum about 0; 0 if it may be any */
    uint32_t        datum_count; /* 0 where it is known */
    uint32_t        is_machine;  /* a probe touches a surface; otherwise edges are injected */
    uint32_t        is_polled;   /* there are touches on the PLC path */
} sim_touches_t;

/* Some touches of one stream, for which the same differs. */
typedef struct {
    uint32_t              stream;
    const sim_recorded_t *recorded;
    const sim_recorded_t *latches[2]; /* on the skip path and by the PLC; NULL if there is none */
    const uint64_t       *rows;       /* numbers of the touches: count, all of them known */
    uint64_t              count;
    const sim_change_t   *change;
    double                widening; /* of the law, for a coarse search, in the stream's unit */
    double                far;      /* size that a tenth of the residuals exceeds */
} sim_member_t;

#endif
