/*
 * A machine for tests of cycle 451: rotary axes A, B and C about X, Y and Z through the origin, A
 * nearest to the bed, all under the sphere. It carries out what the cycle asks for, at once, and
 * writes it down. What it believes of itself is true.
 */
#ifndef SUPPORT_CYCLE451_MACHINE_H
#define SUPPORT_CYCLE451_MACHINE_H

#include "cycle/kinematics_cycle.h"

#define CYCLE451_LOG_MAX 2048

typedef struct {
    kinematics_cycle_t         cycle;
    kinematics_settings_t      settings;
    kinematics_cycle_machine_t data;
    kinematics_cycle_request_t log[CYCLE451_LOG_MAX];
    int                        count;
    int                        impossible_at;          /* this request fails; -1: none does */
    double                     sphere_mm[LINEAR_AXES]; /* with all axes at 0 */
    double                     radius_mm;              /* the true one of the sphere */
    double                     backlash_deg[ROTARY_AXES];
    double                     angle_deg[ROTARY_AXES]; /* true ones */
    double                     change_mm;              /* what an evaluation says */
} cycle451_machine_t;

/* The first program of the document, sphere at (80, 20, 40), option 52 there, preset set. */
void cycle451_set_up(cycle451_machine_t *machine);

/* The sphere's centre with the axes at `angle_deg`. */
void cycle451_centre(const cycle451_machine_t *machine, const double *angle_deg, double *centre_mm);

/* Q<id> = value. */
void cycle451_set(cycle451_machine_t *machine, uint16_t id, double value);

kinematics_cycle_error_t cycle451_start(cycle451_machine_t *machine);

/* Start, and carry out request after request until the cycle ends. */
kinematics_cycle_state_t cycle451_run(cycle451_machine_t *machine);

/* How many requests of this kind were made. */
int cycle451_asked(const cycle451_machine_t *machine, kinematics_cycle_request_kind_t kind);

/* Index in the log of the first request of this kind at or after `from`, -1 if there is none. */
int cycle451_find(const cycle451_machine_t *machine, kinematics_cycle_request_kind_t kind,
                  int from);

#endif
