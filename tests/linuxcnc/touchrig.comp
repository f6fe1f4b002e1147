component touchrig "A simulated axis and probe: the contact lies anywhere between two ticks, by the clock";
description """What is commanded at a tick of the servo thread is reached one period later, at constant speed between. The
line is closed while the axis is past the surface; with *bounces* it opens so often after each contact, *bounce-us* long.""";

pin in float position_cmd;
pin in float surface = 1000.0 "closed where the axis is past it, in mm";
pin in u32 bounces "openings of the contact after it has closed";
pin in float bounce_us = 300.0 "how long each opening lasts, and each closing between them";
pin out float position_fb "what the encoder shows at the servo tick";
pin out bit line "in the fast thread";
pin out bit line_servo "at the servo tick, as an input that is polled there";
pin out u32 late_ticks "servo ticks that came more than a tenth of a period late or early";

function read "encoder and polled input; first in the servo thread";
function write "takes the command; last in the servo thread";
function probe nofp "the line; in the fast thread";

variable rtapi_s64 begun_ns;
variable rtapi_s64 read_ns;
variable rtapi_s64 closed_ns;
variable double from;
variable double to;
variable long servo_ns = 1000000;
license "Apache-2.0";
author "skiplatch";
;;
#include <rtapi_math.h>

/* Where the axis is at `ns`: on its way from `start` to `end`, which takes `length_ns`. */
static double axis_at(double start, double end, rtapi_s64 begun, long length_ns, rtapi_s64 ns)
{
    double share = (double)(ns - begun) / (double)length_ns;
    return start + (end - start) * (share < 1.0 ? share : 1.0);
}

/* Open in every other interval of `bounce` for the first `count` of them after the contact. */
static int is_open(rtapi_s64 since_ns, double bounce, unsigned count)
{
    long interval = (long)((double)since_ns / (1000.0 * bounce));
    return interval < 2L * (long)count && interval % 2L == 1L;
}

static int line_at(struct __comp_state *__comp_inst, rtapi_s64 now_ns)
{
    if (axis_at(from, to, begun_ns, servo_ns, now_ns) < surface) {
        closed_ns = 0;
        return 0;
    }
    if (closed_ns == 0) {
        closed_ns = now_ns;
    }
    return !is_open(now_ns - closed_ns, bounce_us, bounces);
}

FUNCTION(read)
{
    rtapi_s64 now_ns = rtapi_get_time();
    servo_ns = period;
    if (read_ns != 0 && fabs((double)(now_ns - read_ns - period)) > 0.1 * (double)period) {
        ++late_ticks;
    }
    read_ns = now_ns;
    position_fb = axis_at(from, to, begun_ns, servo_ns, now_ns);
    line_servo = line_at(__comp_inst, now_ns);
}

FUNCTION(write)
{
    rtapi_s64 now_ns = rtapi_get_time();
    (void)period;
    from = axis_at(from, to, begun_ns, servo_ns, now_ns);
    to = position_cmd;
    begun_ns = now_ns;
}

FUNCTION(probe)
{
    (void)period;
    line = line_at(__comp_inst, rtapi_get_time());
}
