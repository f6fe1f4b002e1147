/* The grid of a scan whose period is not always the same. Behind scan_grid.h. */
#ifndef DIAGNOSIS_WANDERING_GRID_H
#define DIAGNOSIS_WANDERING_GRID_H

#include <stdbool.h>
#include <stdint.h>

/*
 * Write how much likelier n stamps are about the grid of a period to values[n], and tell whether
 * they keep one. `turns` are shares of the period, in order of time; `tick` is one as well; `room`
 * for 2 n doubles.
 *
 * A period that differs seldom stays the same: its grid runs ahead and lags again, which stamps
 * close to each other in time show alike. Where they do not, each scan is late by itself, and that
 * is another effect's; the little it counts here leads to the period that both have together: those
 * are held against all others, `everywhere`. Each stamp is held against the others only, with von
 * Mises' law for what is on a circle.
 */
bool weigh_wandering(const double *turns, uint64_t n, double tick, bool everywhere, double *room,
                     double *values);

#endif
