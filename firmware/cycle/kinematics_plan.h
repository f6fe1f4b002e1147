/*
 * Where cycles 451 and 452 measure: the measuring positions of each rotary axis, from start, end,
 * number and Hirth grid, and the stations that all of them give; and cycle 453, over a grid.
 */
#ifndef CYCLE_KINEMATICS_PLAN_H
#define CYCLE_KINEMATICS_PLAN_H

#include <stdbool.h>
#include <stdint.h>

#include "comp/kinematics_grid.h"
#include "cycle/kinematics_settings.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum { ROTARY_A, ROTARY_B, ROTARY_C } rotary_axis_t;

#define ROTARY_AXES             3
#define LINEAR_AXES             3 /* X, Y, Z */
#define KINEMATICS_POINTS_MAX   12
#define KINEMATICS_STATIONS_MAX (ROTARY_AXES * (1 + 2 * KINEMATICS_POINTS_MAX))

typedef struct {
    bool   is_present; /* what stands in the settings for an absent axis is ignored */
    double grid_deg;   /* of a Hirth coupling, below 360; 0: the axis stands anywhere */
} kinematics_plan_axis_t;

/* One measurement of the sphere. */
typedef struct {
    double  angle_deg[ROTARY_AXES];
    uint8_t axis;                   /* rotary_axis_t that is being measured */
    uint8_t serves;                 /* bit 1 << axis of every axis whose measurement this is */
    int8_t  approach;               /* 1 with rising angle, −1 with falling angle, 0 as it comes */
    bool    is_reference;           /* `axis` at 0° */
    bool    is_second;              /* of the two approaches; the first one stands just before */
    double  centre_mm[LINEAR_AXES]; /* as measured */
    double  radius_mm;              /* of the sphere, as measured */
} kinematics_station_t;

typedef struct {
    kinematics_station_t stations[KINEMATICS_STATIONS_MAX];
    uint8_t              count;
    uint8_t              measured; /* the first ones have a centre and a radius */
    /* Of each axis that is measured with its backlash: so far before an angle it passes on its way
     * there, with falling angle if below 0; 0: it goes as it comes. */
    double side_deg[ROTARY_AXES];
} kinematics_plan_t;

/*
 * Write the measuring positions from `start_deg` to `end_deg` in equal steps of (end − start) /
 * (points − 1), rounded to the grid (a tie away from 0°), and return how many there are. A position
 * at 0°, or a full turn from it, is that of the reference and left out. One point alone is at the
 * start. `points` ≤ KINEMATICS_POINTS_MAX. Any context.
 */
uint8_t kinematics_plan_positions(double start_deg, double end_deg, uint8_t points, double grid_deg,
                                  double *positions_deg);

/*
 * Plan a whole cycle: axis A, then B, then C; of each the reference at 0° and its positions, with
 * the other axes at their incidence angles (on their grid). A reference that stands in the plan
 * already is not measured again. If Q432 is not 0, every position of an axis without a grid, and
 * that is `may_reverse`, is approached from both sides, Q432 away, first as its sign says; the
 * reference, and where it stands while other axes are measured, from the first side, so that its
 * lost motion is the same everywhere. Cycle 452 that measures no axis measures the sphere once,
 * which serves none. `settings` are sound. Any context.
 */
void kinematics_plan_make(kinematics_plan_t *plan, const kinematics_settings_t *settings,
                          const kinematics_plan_axis_t *axes, bool may_reverse);

/*
 * Plan cycle 453: first the position of a sound grid with all axes at 0°, the reference, then the
 * others, each axis with rising angle. They serve no axis. Any context.
 */
void kinematics_plan_make_grid(kinematics_plan_t *plan, const kinematics_grid_t *grid);

/* Whether the axes of a grid are there, and all its nodes on their Hirth grids. Any context. */
bool kinematics_plan_grid_fits(const kinematics_grid_t *grid, const kinematics_plan_axis_t *axes);

/* Whether a plan measures an axis, and the setting (kinematics_setting_t) of its incidence angle.
 * Any context. */
bool    kinematics_plan_measures(const kinematics_plan_t *plan, uint8_t axis);
uint8_t kinematics_plan_incidence(uint8_t axis);

/* Whether an axis that stands at `angle_deg` need not turn, and all of them. Any context. */
bool kinematics_plan_is_there(double angle_deg, double target_deg);
bool kinematics_plan_is_pose(const double *angles_deg, const double *others_deg);

#ifdef __cplusplus
}
#endif

#endif
