/*
 * How far an axis goes on after a latch, and the feed at which that stays within bounds.
 * Source: constant speed during the reaction, then constant deceleration: s = v·t + v²/2a.
 */
#ifndef CYCLE_OVERTRAVEL_H
#define CYCLE_OVERTRAVEL_H

#ifdef __cplusplus
extern "C" {
#endif

/* What lies between the latch and the standstill. */
typedef struct {
    double reaction_us; /* latch to the start of the deceleration: scan, task, motion queue; ≥ 0 */
    double accel_mm_s2; /* deceleration, > 0 */
} overtravel_path_t;

/* Overtravel in µm at `feed_mm_min` ≥ 0. Task. */
double overtravel_um(const overtravel_path_t *path, double feed_mm_min);

/* The feed in mm/min whose overtravel is `allowed_um` ≥ 0; any lower feed is safe. Task. */
double overtravel_safe_feed_mm_min(const overtravel_path_t *path, double allowed_um);

#ifdef __cplusplus
}
#endif

#endif
