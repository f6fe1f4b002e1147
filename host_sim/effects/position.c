/*
 * Effects on the position that is latched. An error of the axis counts in its own sense: along the
 * approach it takes the sign of the motion.
 */
#include <math.h>
#include <stdbool.h>

#include "angle.h"
#include "effects/effect.h"

#define CALIBRATION_C 20.0
#define UM_PER_MM     1000.0
#define PPM           1.0e-6

/* How far past the nominal surface the axis shows itself, in µm, from how far past the real one. */
static double shown_um(const sim_effect_call_t *call, double position_um)
{
    return position_um + call->touch->datum_um;
}

/* Axis coordinate in mm of a position in µm past the surface. */
static double coordinate_mm(const sim_effect_call_t *call, double position_um)
{
    return call->touch->position_mm + call->touch->sign * shown_um(call, position_um) / UM_PER_MM;
}

/* What Y and Z have more than X. */
static double beyond_x(const sim_effect_call_t *call, const double more[2])
{
    int32_t axis = call->touch->axis;
    return axis == SIM_AXIS_X ? 0.0 : more[axis == SIM_AXIS_Y ? 0 : 1];
}

/* An error that differs from axis to axis, over that of X; the parameters say by how much more. */
static double over_x(const sim_effect_call_t *call, const double more[2])
{
    return 1.0 + beyond_x(call, more);
}

double effect_servo_hold(const sim_effect_call_t *call, double time_us)
{
    double period_us = call->parameters[0];
    double first_us = effect_origin(call, call->parameters[2] / DEG_PER_TURN) * period_us;
    return first_us + floor((time_us - first_us) / period_us) * period_us - call->parameters[1];
}

/* The commanded position is ahead of the real one by the way of the lag. */
double effect_following_error(const sim_effect_call_t *call, double position_um)
{
    double lag_us = call->parameters[0] * over_x(call, &call->parameters[1]);
    double off_us = sim_random_normal(call->random, fmin(call->parameters[3], fabs(lag_us)));
    return position_um + call->speed_um_us * (lag_us + off_us);
}

/* What reads high is behind along an approach in the negative sense. */
double effect_backlash(const sim_effect_call_t *call, double position_um)
{
    double play_um = call->touch->sign < 0.0 ? -call->parameters[0] : call->parameters[1];
    return position_um + play_um * over_x(call, &call->parameters[2]);
}

double effect_transmission_error(const sim_effect_call_t *call, double position_um)
{
    double ahead = beyond_x(call, &call->parameters[9]) / DEG_PER_TURN;
    bool   is_at_surface = call->parameters[11] > 0.5;
    double where_mm = is_at_surface ? call->touch->position_mm : coordinate_mm(call, position_um);
    double turn = where_mm / call->parameters[1] + ahead;
    double error_um = call->parameters[0] * sim_wave(turn, call->parameters[2]) +
                      call->parameters[3] * sim_wave(2.0 * turn, call->parameters[4]) +
                      call->parameters[5] * sim_wave(3.0 * turn, call->parameters[6]);
    return position_um + call->touch->sign * error_um * over_x(call, &call->parameters[7]);
}

double effect_scale_error(const sim_effect_call_t *call, double position_um)
{
    double error_um = coordinate_mm(call, position_um) * UM_PER_MM * call->parameters[0] * PPM;
    return position_um + call->touch->sign * error_um * over_x(call, &call->parameters[1]);
}

double effect_encoder_quantisation(const sim_effect_call_t *call, double position_um)
{
    double step_um = call->parameters[0];
    if (call->parameters[1] > 0.5) {
        double origin = effect_origin(call, call->parameters[2]);
        double where_um = coordinate_mm(call, position_um) * UM_PER_MM;
        double line_um = (rint(where_um / step_um - origin) + origin) * step_um;
        return position_um + call->touch->sign * (line_um - where_um);
    }
    double where_um = shown_um(call, position_um);
    return position_um + rint(where_um / step_um) * step_um - where_um;
}

static double followed_c(const sim_touch_t *touch, double thermometer)
{
    return thermometer < 0.5 ? touch->temp_c : touch->further_temp_c[lround(thermometer) - 1];
}

/* State: whether there is a history, its time in s, and the lagged temperature. */
double effect_thermal_drift(const sim_effect_call_t *call, double position_um)
{
    double *has_history = &call->state[0];
    double *last_s = &call->state[1];
    double *lagged_c = &call->state[2];
    double  now_s = call->touch->time_s;
    double  lag_s = call->parameters[2];
    double  now_c = followed_c(call->touch, call->parameters[8]);

    if (lag_s <= 0.0) {
        *lagged_c = now_c;
    } else if (*has_history < 1.0) {
        *lagged_c = CALIBRATION_C + (1.0 - call->parameters[3]) * (now_c - CALIBRATION_C);
    } else {
        *lagged_c += (now_c - *lagged_c) * -expm1(-(now_s - *last_s) / lag_s);
    }
    *has_history = 1.0;
    *last_s = now_s;
    double where_um = coordinate_mm(call, position_um) * UM_PER_MM;
    double um_k = call->parameters[0] + call->parameters[1] * PPM * where_um;
    double error_um = um_k * (*lagged_c - CALIBRATION_C);
    double sense = call->parameters[6] > 0.5 ? 1.0 : call->touch->sign;
    return position_um + sense * error_um * over_x(call, &call->parameters[4]);
}

/* The centre lies at c instead of 0: a table turned by θ carries a workpiece that was set
 * at 0° to c − R(θ)·c, and one on the believed centre to −R(θ)·c. */
double effect_rotary_pivot(const sim_effect_call_t *call, double position_um)
{
    double sense = call->parameters[3] > 0.5 ? -1.0 : 1.0;
    double turn = sense * call->touch->rotary_deg * RAD_PER_DEG;
    double direction = call->touch->alpha_deg * RAD_PER_DEG;
    double x_um = call->parameters[0];
    double y_um = call->parameters[1];
    double kept = 1.0 - call->parameters[2];
    double shift_x_um = kept * x_um - (cos(turn) * x_um - sin(turn) * y_um);
    double shift_y_um = kept * y_um - (sin(turn) * x_um + cos(turn) * y_um);
    double along_um = cos(direction) * shift_x_um + sin(direction) * shift_y_um;
    return position_um + along_um * cos(call->touch->beta_deg * RAD_PER_DEG);
}
