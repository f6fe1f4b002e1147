#include "axis.h"

#define UM_PER_MM       1000.0
#define NS_PER_MIN      60.0e9
#define MM_S2_TO_UM_NS2 (UM_PER_MM / (SIM_NS_PER_S * SIM_NS_PER_S))

void sim_axis_place(sim_axis_t *axis, double accel_mm_s2, double position_um, sim_ns_t now)
{
    *axis = (sim_axis_t){
        .accel = accel_mm_s2 * MM_S2_TO_UM_NS2,
        .from_um = position_um,
        .sense = 1.0,
        .start = now,
    };
}

/* The speed, or what the axis reaches of it by accelerating over `length`. */
static double limit_speed(double speed, double accel, double length)
{
    double reached_squared = 2.0 * accel * length;
    return speed * speed < reached_squared ? speed : sqrt(reached_squared);
}

/* Work out the rest once speed and the times up to the deceleration are known. */
static void complete(sim_axis_t *axis)
{
    axis->decel_end = axis->decel_start + axis->accel_end;
    axis->ramp_um = 0.5 * axis->speed * axis->accel_end;
    axis->to_brake_um = axis->ramp_um + axis->speed * (axis->decel_start - axis->accel_end);
}

void sim_axis_move(sim_axis_t *axis, double target_um, double feed_mm_min, sim_ns_t now)
{
    double from_um = sim_axis_position_um(axis, now);
    double length = fabs(target_um - from_um);
    double speed = limit_speed(feed_mm_min * (UM_PER_MM / NS_PER_MIN), axis->accel, length / 2.0);

    if (from_um < 0.0 && target_um > 0.0) {
        speed = limit_speed(speed, axis->accel, -from_um);
    }
    axis->start = now;
    axis->from_um = from_um;
    axis->sense = target_um < from_um ? -1.0 : 1.0;
    axis->speed = speed;
    axis->accel_end = speed / axis->accel;
    axis->decel_start = speed > 0.0 ? length / speed : 0.0;
    complete(axis);
}

void sim_axis_stop(sim_axis_t *axis, sim_ns_t reaction, sim_ns_t now)
{
    double brake = (double)(now + reaction - axis->start);
    if (brake >= axis->decel_start) {
        return;
    }
    if (brake < axis->accel_end) {
        axis->accel_end = brake;
        axis->speed = axis->accel * brake;
    }
    axis->decel_start = brake;
    complete(axis);
}

/* Way from the start of the motion after `time` ns. */
static double way_at(const sim_axis_t *axis, double time)
{
    double whole = axis->to_brake_um + axis->ramp_um;

    if (time < 0.0) { /* a servo may hold what it read before the motion */
        return 0.0;
    }
    if (time < axis->accel_end) {
        return 0.5 * axis->accel * time * time;
    }
    if (time < axis->decel_start) {
        return axis->ramp_um + axis->speed * (time - axis->accel_end);
    }
    if (time < axis->decel_end) {
        double left = axis->decel_end - time;
        return whole - 0.5 * axis->accel * left * left;
    }
    return whole;
}

double sim_axis_position_um(const sim_axis_t *axis, sim_ns_t now)
{
    return axis->from_um + axis->sense * way_at(axis, (double)(now - axis->start));
}

double sim_axis_speed_um_us(const sim_axis_t *axis, sim_ns_t now)
{
    double time = (double)(now - axis->start);
    double speed = axis->speed;
    if (time < axis->accel_end) {
        speed = fmax(0.0, axis->accel * time);
    } else if (time >= axis->decel_start) {
        speed = fmax(0.0, axis->accel * (axis->decel_end - time));
    }
    return axis->sense * speed * SIM_NS_PER_US;
}

/* Rounded up, so that the axis is at rest by then. */
sim_ns_t sim_axis_standstill(const sim_axis_t *axis)
{
    return axis->start + (sim_ns_t)axis->decel_end + 1;
}

/* Time at which `way` is covered, way_at() turned round; below 0 if the motion ends before. */
static double time_at(const sim_axis_t *axis, double way)
{
    if (way <= axis->ramp_um) {
        return sqrt(2.0 * way / axis->accel);
    }
    if (way <= axis->to_brake_um) {
        return axis->accel_end + (way - axis->ramp_um) / axis->speed;
    }
    double left = axis->to_brake_um + axis->ramp_um - way;
    return left < 0.0 ? -1.0 : axis->decel_end - sqrt(2.0 * left / axis->accel);
}

sim_ns_t sim_axis_crossing(const sim_axis_t *axis, double position_um)
{
    double way = axis->sense * (position_um - axis->from_um);
    double time = way < 0.0 ? -1.0 : time_at(axis, way);
    return time < 0.0 ? SIM_NEVER : axis->start + (sim_ns_t)llrint(time);
}
