/*
 * Location errors of rotary axes (ISO 230-7) from the centres of a sphere measured at several
 * positions of the axes: Gauss-Newton over the chain, with a rank analysis that names what the
 * positions cannot determine. No clock, no HAL; task context, 20 kB of stack (to recommend: 32 kB).
 *
 * The chain. A table axis at θ carries the sphere: y ↦ q + R(n, θ)·(y − q); a head axis carries the
 * tool likewise. n and q are direction and a point of the axis average line with every axis at 0,
 * in machine coordinates (of a head: with the linear axes at 0). With the tip in the sphere's
 * centre the linear axes then read p = table₁(table₂(… sphere)) − (head₁(head₂(… tip)) − tip): the
 * sphere's centre itself with every axis at 0, and no compensation of the tool's tilt (TCPM off).
 * Where the sphere and the tip stand is unknown; so the pivot of a head cannot be told from the
 * length of the tool.
 *
 * Location errors are actual minus believed, at the believed point, in machine coordinates:
 * XOC, YOC are the offsets of the C line in the plane of constant Z through the believed point;
 * AOC, BOC the right-handed turns about X and Y that carry the believed direction into the actual
 * one; COC is the error of the zero: at the reading 0 the axis stands at COC. A: YOA, ZOA, BOA,
 * COA, AOA. B: XOB, ZOB, AOB, COB, BOB. The zero cannot be told from the lines of the axes carried
 * and from the place of the sphere (or tip), so it is taken as believed and named undetermined,
 * unless `zero_is_free` and the tilt that it goes with is held.
 *
 * Python reads this header too: no more of the preprocessor than what can be left out.
 */
#ifndef COMP_KINEMATICS_H
#define COMP_KINEMATICS_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum {
    KINEMATICS_AXES_MAX = 3,
    KINEMATICS_OF_AXIS = 5, /* two offsets, two tilts, the zero */
    KINEMATICS_PARAMETERS_MAX = 15,
    KINEMATICS_NUISANCES = 6, /* place of the sphere and of the tip */
    KINEMATICS_UNKNOWNS_MAX = 21
};

enum {
    KINEMATICS_OK = 0,
    KINEMATICS_ERR_MACHINE = -1, /* no axis or too many, letter not A to C or twice, not finite,
                                    a direction that is no unit vector (1e-4) or lies more than
                                    60° from the letter's own coordinate, scatter below 0 */
    KINEMATICS_ERR_POINT = -2,   /* a value is not finite */
    KINEMATICS_ERR_TOO_FEW = -3, /* no more coordinates measured than unknowns determined */
    KINEMATICS_ERR_NO_FIT = -4   /* no solution within 30° and 1 m of what is believed, or none
                                    in numbers that are finite */
};

typedef struct {
    int32_t letter;       /* 'A', 'B' or 'C' */
    int32_t is_head;      /* carries the tool, not the sphere */
    double  direction[3]; /* believed, of length 1; the sense of positive angles */
    double  point_mm[3];  /* believed point of the axis line */
    int32_t is_held[4];   /* offsets and tilts, as named above: not fitted but as believed */
    int32_t zero_is_free; /* to be fitted */
} kinematics_axis_t;

typedef struct {
    int32_t           axes_count;
    kinematics_axis_t axes[KINEMATICS_AXES_MAX]; /* table from the bed outwards and head from the
                                                    ram to the tool */
    int32_t tool_is_known;
    double  tool_mm[3]; /* the tip with all axes at 0; used only when known */
    /* How many times a coordinate along the tool, which points along Z with all axes at 0, scatters
     * as one across it; 0 counts as 1. */
    double axial_scatter;
} kinematics_machine_t;

typedef struct {
    double angle_deg[KINEMATICS_AXES_MAX]; /* in the order of the machine's axes */
    double position_mm[3];                 /* what the linear axes read at the sphere's centre */
} kinematics_point_t;

enum {
    KINEMATICS_UNDETERMINED = 0, /* left alone: value and uncertainty are 0 */
    KINEMATICS_DETERMINED = 1,
    KINEMATICS_COMBINED = 2, /* the value is that of a combination: of this parameter, less
                                per_unit[this] of each undetermined one that it is named with */
    KINEMATICS_HELD = 3      /* not fitted; value and uncertainty are 0 */
};

typedef struct {
    int32_t state;
    int32_t is_angle;
    double  value;      /* µm or arcsec */
    double uncertainty; /* standard uncertainty in the same unit, widened for few degrees of freedom
                           so that ±3 of it hold 99.73 % (GUM G.3, table G.2) */
    char name[4];       /* "XOC" */
} kinematics_parameter_t;

/* A change of the parameters that shows at no position: 1 of `parameter`, and some of others. */
typedef struct {
    int32_t parameter;                           /* index */
    int32_t with_sphere;                         /* the sphere's place changes too */
    int32_t with_tip;                            /* the tip's place changes too */
    int32_t named[KINEMATICS_PARAMETERS_MAX];    /* it changes too, by more than the errors make */
    double  per_unit[KINEMATICS_PARAMETERS_MAX]; /* µm or arcsec per µm or arcsec */
} kinematics_blind_t;

typedef struct {
    int32_t                parameters_count; /* KINEMATICS_OF_AXIS for each axis, in their order */
    kinematics_parameter_t parameters[KINEMATICS_PARAMETERS_MAX];
    int32_t                blind_count;
    kinematics_blind_t     blind[KINEMATICS_PARAMETERS_MAX];
    int32_t unknowns; /* parameters, sphere and, with an axis in the head, an unknown tip */
    int32_t rank;
    int32_t freedom;      /* coordinates measured minus rank */
    double  residual_um;  /* standard deviation of one coordinate across the tool */
    double  sphere_mm[3]; /* with every axis at 0 */
    double  tip_mm[3];    /* the same; as given where it is known */
} kinematics_result_t;

/*
 * Fit `points` (n). A parameter is undetermined when together with the others it moves the
 * measured coordinates by less than 1e-4 (root mean square; mm/mm, or mm per 1/100 rad).
 * Returns KINEMATICS_OK or an error; then `result` holds nothing.
 */
int kinematics_fit(const kinematics_machine_t *machine, const kinematics_point_t *points, int32_t n,
                   kinematics_result_t *result);

/* How far the axes may be driven when positions are recommended: low to high within 1e6. */
typedef struct {
    double low_deg[KINEMATICS_AXES_MAX];
    double high_deg[KINEMATICS_AXES_MAX];
} kinematics_travel_t;

/*
 * Recommend further positions, on a grid of 30° within the travel (a turn of it about 0): always
 * the one that tells most (D-optimal), until every parameter that the grid can determine would be
 * known to twice the noise of a coordinate (tilts: at 100 mm), or `max` are found. Writes angles
 * and expected coordinates to `more`; `after` tells what the old and new positions determine
 * together, without values. Returns the number of positions or an error; `n` of 0 is an error, one
 * point is enough.
 */
int32_t kinematics_recommend(const kinematics_machine_t *machine, const kinematics_point_t *points,
                             int32_t n, const kinematics_travel_t *travel, int32_t max,
                             kinematics_point_t *more, kinematics_result_t *after);

#ifdef __cplusplus
}
#endif

#endif
