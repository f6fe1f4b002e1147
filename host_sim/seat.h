/*
 * The mechanics of a probe with a three-contact seat: a spring holds the stylus carrier down on
 * three contacts, and the probe triggers when the force at the tip tilts it off one of them. Until
 * then the stylus bends, and the bending is the pretravel.
 */
#ifndef SIM_SEAT_H
#define SIM_SEAT_H

#include <stdbool.h>

#include "chain.h"

/* Where the tip comes to rest: off the centre, towards where it was pushed last. */
typedef struct {
    double pushed[3]; /* unit vector of that push; 0 before the first one */
} sim_rest_t;

static inline bool sim_has_seat(const sim_chain_t *chain)
{
    return chain->seat.spring_n > 0.0;
}

/*
 * Force in N at which the probe triggers when its tip is pushed in the direction (α, β), β from 0
 * (across the stylus) to 90 (along it):
 * F = F_s·(d/L) / (cos β·((1 − c)·cos ψ + 0.827·c) + (d/L)·sin β), with ψ the angle to the nearest
 * direction of least force, |ψ| ≤ 60°, and 0.827 the mean of cos ψ.
 */
double sim_seat_force_n(const sim_seat_t *seat, double alpha_deg, double beta_deg);

/*
 * Pretravel in µm until then: w = F·(K_b·cos²β + K_a·sin²β), where K_b = L³/(3·E·I) is that of a
 * clamped bar, and K_a = axial_um_n.
 */
double sim_seat_pretravel_um(const sim_seat_t *seat, double alpha_deg, double beta_deg);

/*
 * What a push in the direction (α, β) finds more than one that repeats the push before, µm:
 * reseat·(cos of the angle between both − 1). The push is remembered in `rest`.
 */
double sim_seat_reseat_um(const sim_seat_t *seat, sim_rest_t *rest, double alpha_deg,
                          double beta_deg);

#endif
