/*
 * The geometry of a five-axis machine as it really is: three linear axes that carry the probe, and
 * rotary axes under the sphere (table) or above the probe (head), each with location errors and
 * errors of its own. Python reads this header; plain declarations only.
 *
 * Coordinates are those of the machine in mm. A reading of the linear axes is where the tip is
 * while all rotary axes stand at zero. The lines of the axes are given in that state too; those of
 * a head, and where the tip is seen from them, in any one frame that travels with the ram. A
 * positive angle turns right-handed about the direction.
 */
#ifndef SIM_FIVE_AXIS_H
#define SIM_FIVE_AXIS_H

#include <stdint.h>

enum { SIM_ROTARY_A = 0, SIM_ROTARY_B = 1, SIM_ROTARY_C = 2, SIM_ROTARIES = 3 };

/* One rotary axis. Its location errors stand beside what is believed of it. */
typedef struct {
    double direction[3];   /* believed; a unit vector */
    double point_mm[3];    /* believed; any point of the line */
    double datum_deg;      /* believed; the control shows so much more than the encoder */
    double offset_mm[3];   /* location error: the line lies so far off, X0C, Y0C … */
    double tilt_rad[3];    /* location error: turned about X, then Y, then Z, A0C, B0C … */
    double zero_deg;       /* location error: true angle where the encoder shows 0 */
    double backlash_deg;   /* lost motion between the two senses, ≥ 0 */
    double once_deg;       /* positioning error: amplitude once a turn */
    double once_phase_deg; /* where it begins */
    double twice_deg;      /* the same twice a turn */
    double twice_phase_deg;
    double radial_mm;         /* geometric error: the line runs round a circle twice a turn */
    double axial_mm;          /* geometric error: it moves along itself once a turn */
    double repeatability_deg; /* scatter of a move, 1 sigma */
} sim_rotary_t;

/* Believed: a grid of positions and what the linear axes go more there, firmware/comp. */
typedef struct {
    int32_t count[3]; /* nodes of A, B, C; 0: none */
    double  node_deg[3][25];
    double  offset_mm[75][3]; /* C is the fastest */
} sim_grid_t;

/* A machine, the sphere on its table and the ball of its probe. */
typedef struct {
    sim_rotary_t axes[3];
    int32_t      table[3];        /* SIM_ROTARY_*, from the bed outwards; -1 ends the list */
    int32_t      head[3];         /* SIM_ROTARY_*, from the ram to the tool; -1 ends the list */
    double       tool_mm[3];      /* the tip among the lines of the head, all rotary axes at zero */
    double       tip_mm[3];       /* believed; the tip has since moved so far from there */
    double       tip_error_mm[3]; /* and truly so much farther: another head, a drift */
    sim_grid_t   grid;
    double       sphere_mm[3]; /* centre of the sphere, all rotary axes truly at zero */
    double       sphere_radius_mm;
    double       tip_radius_mm;
    double       scale_ppm[3];  /* linear axes: so much longer than they show */
    double       square_rad[3]; /* XY, XZ, YZ: the second axis leans so much towards the first */
} sim_machine_t;

/* Where the rotary axes stand. */
typedef struct {
    double command_deg[3]; /* what their encoders were last told */
    double pushed_deg[3];  /* what they show when a positive move has just used up the play */
    double load_deg[3];    /* true angles */
} sim_stance_t;

/*
 * Whether it can be played: lists that hold an axis once and none that there is not, at least one
 * in all; directions of length 1 (1e-4); radii above 0, the tip's at least 0; backlash and
 * scatter at least 0; all finite.
 */
int32_t sim_machine_is_sound(const sim_machine_t *machine);

/* Stand at zero, come there in the positive sense. */
void sim_machine_home(const sim_machine_t *machine, sim_stance_t *stance);

/*
 * Turn one axis to `command_deg`, missing it by `scatter_deg`. With backlash the load follows only
 * once the play is used up.
 */
void sim_machine_turn(const sim_machine_t *machine, sim_stance_t *stance, int32_t axis,
                      double command_deg, double scatter_deg);

/* Centre of the sphere as the table has carried it. */
void sim_machine_sphere(const sim_machine_t *machine, const sim_stance_t *stance,
                        double centre_mm[3]);

/* Where the tip really is at a reading of the linear axes. */
void sim_machine_tip(const sim_machine_t *machine, const sim_stance_t *stance,
                     const double reading_mm[3], double tip_mm[3]);

/* Turn a direction given in the frame of the probe (Z along it, away from the tip) with the head.
 */
void sim_machine_probe_direction(const sim_machine_t *machine, const sim_stance_t *stance,
                                 const double in_probe[3], double in_machine[3]);

/*
 * How far the linear axes have to show from `start_mm` along the unit vector `direction` until the
 * ball touches the sphere; NaN when it passes by, below 0 when it has passed already.
 */
double sim_machine_distance_mm(const sim_machine_t *machine, const sim_stance_t *stance,
                               const double start_mm[3], const double direction[3]);

#endif
