component skiplatch "Latches a touch probe in a fast thread: the first edge counts, debouncing never moves it";
description """
The function *fast* belongs into the fastest thread that there is. It keeps the time of the first edge of a touch, halfway
between the two ticks that it came between, and debounces afterwards. The function *servo* belongs into the servo thread,
behind whatever reads the feedback and before motion-controller: it gives the position at that time, interpolated between
the ticks of the servo thread.

*probe-out* goes to motion.probe-input. It rises once a touch is confirmed and falls only when the line has been open for
*release-us*, so a contact that bounces while the axis brakes does not end the program. *feedback-out* may go to
joint.N.motor-pos-fb: it is *position-fb*, but for the tick in which *probe-out* rises, where it is the latched position;
so #5061 to #5069 and PROBEOPEN have the latched position, and programs stay as they are. FERROR has to allow the way of
*confirm-us* and two servo periods. Probing away from a surface (G38.4, G38.5) is not latched: the line opening is not an
edge. See docs/LINUXCNC.md.""";

pin in bit probe_in "TRUE while the probe is deflected (invert it before, if need be)";
pin in bit enable = 1 "FALSE: edges are counted as unarmed and touch nothing";
pin in float position_fb "position of the axis, as the servo thread reads it";
pin out bit probe_out "TRUE from the confirmed touch to the release, without bounces";
pin out float position "position at the first edge of the last touch";
pin out float feedback_out "position-fb, and for one tick the latched position";
pin out float overtravel "how far the axis went on, from the latched position; signed";
pin out float age_us "from the edge to the tick of the servo thread that told of it, in us";
pin out float window_us "time between the two ticks that the edge came between, in us";
pin out u32 touches "confirmed touches";
pin out u32 bounce_count "further edges of a touch; wraps at 2^16, as the next two";
pin out u32 glitch_count "edges that were none: the line opened again before it was confirmed";
pin out u32 unarmed_count "edges while not enabled";
param rw u32 confirm_us = 500 "how long the line has to stay closed, at most 200000 us";
param rw u32 release_us = 5000 "how long it has to stay open before the next touch";

function fast nofp "latches; in the fastest thread";
function servo "tells the position; in the servo thread, after the feedback is read";

variable latch_t latch_state;
variable rtapi_s64 last_ns;
variable rtapi_s64 closed_ns;
variable rtapi_s64 edge_ns;
variable rtapi_s64 gap_ns;
variable unsigned told;
variable unsigned heard;
variable int line_closed;
variable int armed;
variable int released = 1;
variable rtapi_s64 sample_ns[256];
variable double sample_at[256];
variable unsigned samples;

include "skiplatch.h";
license "Apache-2.0";
author "skiplatch";
;;
#include <rtapi_math.h>

#define SAMPLES        256u
#define CONFIRM_MAX_US 200000u
#define NS_PER_US      1000.0
#define TICK_SHIFT     6 /* ticks of 64 ns wrap after 275 s */
#define TICK_PS        64000u

/* The latch is the fast thread's alone; the servo thread gets whole records from it. */
hal_critical_state_t hal_critical_enter(void)
{
    return 0u;
}

void hal_critical_exit(hal_critical_state_t saved)
{
    (void)saved;
}

static uint32_t ticks_of(rtapi_s64 ns)
{
    return (uint32_t)((uint64_t)ns >> TICK_SHIFT);
}

static void arm(latch_t *latch, uint32_t wait_us)
{
    latch_config_t config = {
        .repeated = false,
        .confirm_ticks = ticks_from_us(wait_us < CONFIRM_MAX_US ? wait_us : CONFIRM_MAX_US, TICK_PS),
        .holdoff_ticks = TICKS_MAX_DURATION, /* until the release, which arms anew */
    };
    latch_arm(latch, &config);
}

/* Armed when enabled and released; a touch that is on its way stays one. */
static void keep_armed(struct __comp_state *__comp_inst)
{
    if (!enable && armed) {
        latch_disarm(&latch_state);
        armed = 0;
    } else if (enable && !armed && released) {
        arm(&latch_state, confirm_us);
        armed = 1;
    }
}

FUNCTION(fast)
{
    rtapi_s64      now_ns = rtapi_get_time();
    uint32_t       now = ticks_of(now_ns);
    int            level = probe_in != 0;
    latch_record_t record;

    (void)period;
    if (last_ns == 0) { /* the first tick: a line that is closed already is no edge */
        latch_init(&latch_state, 0u, 0u);
        line_closed = level;
        released = !level;
        last_ns = closed_ns = now_ns;
    }
    keep_armed(__comp_inst);
    if (level && !line_closed) {
        /* What travels with an edge is how far apart the ticks were that it came between. */
        latch_on_edge(&latch_state, ticks_of(last_ns + (now_ns - last_ns) / 2),
                      (int32_t)(now_ns - last_ns));
    }
    latch_poll(&latch_state, now, level != 0);
    if (latch_take(&latch_state, &record)) {
        edge_ns = now_ns - ((rtapi_s64)(uint32_t)(now - record.ticks) << TICK_SHIFT);
        gap_ns = record.position_counts;
        released = 0;
        __sync_synchronize();
        ++told;
    }
    if (level) {
        closed_ns = now_ns;
    } else if (!released && now_ns - closed_ns >= (rtapi_s64)release_us * 1000) {
        released = 1;
        armed = 0;
    }
    bounce_count = latch_state.counters.bounces;
    glitch_count = latch_state.counters.glitches;
    unarmed_count = latch_state.counters.unarmed;
    line_closed = level;
    last_ns = now_ns;
}

/* Position at `ns`, between the two samples around it; the oldest where it is older than all. */
static double position_at(const rtapi_s64 *times_ns, const double *positions, unsigned count,
                          rtapi_s64 ns)
{
    unsigned held = count < SAMPLES ? count : SAMPLES;
    unsigned later = (count - 1u) % SAMPLES;
    unsigned i;
    for (i = 1u; i < held; ++i) {
        unsigned sooner = (count - 1u - i) % SAMPLES;
        if (times_ns[sooner] <= ns) {
            double share = (double)(ns - times_ns[sooner]) / (double)(times_ns[later] - times_ns[sooner]);
            return positions[sooner] + share * (positions[later] - positions[sooner]);
        }
        later = sooner;
    }
    return positions[later];
}

FUNCTION(servo)
{
    rtapi_s64 now_ns = rtapi_get_time();
    unsigned  newest = told;

    (void)period;
    sample_ns[samples % SAMPLES] = now_ns;
    sample_at[samples % SAMPLES] = position_fb;
    ++samples;
    feedback_out = position_fb;
    if (newest != heard) {
        __sync_synchronize();
        heard = newest;
        position = position_at(sample_ns, sample_at, samples, edge_ns);
        feedback_out = position;
        overtravel = 0.0;
        age_us = (double)(now_ns - edge_ns) / NS_PER_US;
        window_us = (double)gap_ns / NS_PER_US;
        probe_out = 1;
        ++touches;
    } else if (released) {
        probe_out = 0;
    }
    if (probe_out && fabs(position_fb - position) > fabs(overtravel)) {
        overtravel = position_fb - position;
    }
}
