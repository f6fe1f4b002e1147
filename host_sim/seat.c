#include "seat.h"

#include <math.h>

#include "angle.h"

#define CONTACT_DEG 120.0 /* from one contact to the next */
#define MEAN_COSINE 0.827 /* of the angle to the nearest direction of least force */
#define M_PER_MM    1.0e-3
#define UM_PER_M    1.0e6

double sim_seat_force_n(const sim_seat_t *seat, double alpha_deg, double beta_deg)
{
    double arm_ratio = seat->seat_mm / seat->stylus_mm;
    double psi = remainder(alpha_deg - seat->azimuth_deg, CONTACT_DEG) * RAD_PER_DEG;
    double beta = beta_deg * RAD_PER_DEG;
    double across = (1.0 - seat->evenness) * cos(psi) + MEAN_COSINE * seat->evenness;
    return seat->spring_n * arm_ratio / (cos(beta) * across + arm_ratio * sin(beta));
}

static double bending_um_n(const sim_seat_t *seat)
{
    double length_m = seat->stylus_mm * M_PER_MM;
    return UM_PER_M * length_m * length_m * length_m / (3.0 * seat->stem_n_m2);
}

double sim_seat_pretravel_um(const sim_seat_t *seat, double alpha_deg, double beta_deg)
{
    double across = cos(beta_deg * RAD_PER_DEG);
    double along = sin(beta_deg * RAD_PER_DEG);
    double um_n = bending_um_n(seat) * across * across + seat->axial_um_n * along * along;
    return sim_seat_force_n(seat, alpha_deg, beta_deg) * um_n;
}

double sim_seat_reseat_um(const sim_seat_t *seat, sim_rest_t *rest, double alpha_deg,
                          double beta_deg)
{
    double       alpha = alpha_deg * RAD_PER_DEG;
    double       beta = beta_deg * RAD_PER_DEG;
    const double push[3] = {cos(beta) * cos(alpha), cos(beta) * sin(alpha), sin(beta)};
    double       turn_cosine = 0.0;
    for (int i = 0; i < 3; ++i) {
        turn_cosine += push[i] * rest->pushed[i];
        rest->pushed[i] = push[i];
    }
    return seat->reseat_um * (turn_cosine - 1.0);
}
