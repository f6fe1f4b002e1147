component touchrig "A simulated axis and probe: the contact lies anywhere between two ticks, by the clock";
description """What is commanded at a tick of the servo thread is reached one period later, at constant speed between. The
line is closed while the axis is past the surface, in its sense; after each contact it opens *bounces* times, each time
*closing-us* after it has closed and for *bounce-us*.""";

pin in float position_cmd;
pin in float surface = 1000.0 "closed where the axis is past it, in mm";
pin in s32 sense = 1 "1: past is above; -1: below";
pin in u32 bounces "openings of the contact after it has closed";
pin in float bounce_us = 300.0 "how long each opening lasts";
pin in float closing_us = 300.0 "and each closing before it";
pin in float backlash "how far a reversal carries nothing, in mm";
pin in float scale_error "the axis goes 1 + this times as far as the motor";
pin in float lag_us "how long the encoder's signal takes, as a low pass";
pin out float position_fb "what the encoder shows at the servo tick";
pin out bit line "in the fast thread";
pin out bit line_servo "at the servo tick, as an input that is polled there";
pin out float off_us "how far off its time any of the last eight ticks was, when the line was first seen closed";
pin out u32 late_ticks "servo ticks that came more than a tenth of a period late or early";

function read "encoder and polled input; first in the servo thread";
function write "takes the command; last in the servo thread";
function probe nofp "the line; in the fast thread";

variable rtapi_s64 begun_ns;
variable rtapi_s64 read_ns;
variable rtapi_s64 closed_ns;
variable double from;
variable double to;
variable double carried;
variable double shown;
variable int seen;
variable double recent_us[8];
variable unsigned ticks;
variable long servo_ns = 1000000;
license "Apache-2.0";
author "skiplatch";
;;
#include <rtapi_math.h>

#define RECENT 8u

/* Where the motor is at `ns`: on its way from `start` to `end`, which takes `length_ns`. */
static double motor_at(double start, double end, rtapi_s64 begun, long length_ns, rtapi_s64 ns)
{
    double share = (double)(ns - begun) / (double)length_ns;
    return start + (end - start) * (share < 1.0 ? share : 1.0);
}

/* The axis behind a play: the motor carries it along upwards at once, downwards `play` later. */
static double carried_by(double axis, double motor, double play)
{
    return axis < motor ? motor : axis > motor + play ? motor + play : axis;
}

static double worst_of(const double *values, unsigned count)
{
    double   worst = 0.0;
    unsigned i;
    for (i = 0u; i < count; ++i) {
        worst = fmax(worst, values[i]);
    }
    return worst;
}

static int is_open(double since_us, double closing, double opening, unsigned count)
{
    double cycles = since_us / (closing + opening);
    return cycles < (double)count && since_us - floor(cycles) * (closing + opening) >= closing;
}

static int line_at(struct __comp_state *__comp_inst, rtapi_s64 now_ns)
{
    double motor = motor_at(from, to, begun_ns, servo_ns, now_ns);
    carried = carried_by(carried, motor, backlash);
    if ((carried * (1.0 + scale_error) - surface) * (sense < 0 ? -1.0 : 1.0) < 0.0) {
        closed_ns = 0;
        return 0;
    }
    if (closed_ns == 0) {
        closed_ns = now_ns;
    }
    return !is_open((double)(now_ns - closed_ns) / 1000.0, closing_us, bounce_us, bounces);
}

FUNCTION(read)
{
    rtapi_s64 now_ns = rtapi_get_time();
    double    motor = motor_at(from, to, begun_ns, servo_ns, now_ns);
    double    since_us = read_ns == 0 ? 1000.0 : (double)(now_ns - read_ns) / 1000.0;

    servo_ns = period;
    recent_us[ticks % RECENT] = fabs(since_us - (double)period / 1000.0);
    late_ticks += recent_us[ticks % RECENT] > 0.1 * (double)period / 1000.0;
    ++ticks;
    read_ns = now_ns;
    shown = lag_us > 0.0 ? motor + (shown - motor) * exp(-since_us / lag_us) : motor;
    position_fb = shown;
    line_servo = line_at(__comp_inst, now_ns);
    if (line_servo && !seen) {
        off_us = worst_of(recent_us, RECENT);
    }
    seen = line_servo;
}

FUNCTION(write)
{
    rtapi_s64 now_ns = rtapi_get_time();
    (void)period;
    from = motor_at(from, to, begun_ns, servo_ns, now_ns);
    to = position_cmd;
    begun_ns = now_ns;
}

FUNCTION(probe)
{
    (void)period;
    line = line_at(__comp_inst, rtapi_get_time());
}
