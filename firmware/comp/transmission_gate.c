#include "comp/transmission_gate.h"

#define ONE_Q32 INT64_C(4294967296)

/* ---- counting ---- */

static int64_t fraction_q32(const transmission_t *t, uint32_t over)
{
    return (int64_t)((over * t->under_inverse) >> 32);
}

void transmission_gate_shift_zero(transmission_t *t)
{
    int64_t most_q32 = TRANSMISSION_LINES_MOST * ONE_Q32;
    bool    is_ahead = t->lines > 0;
    t->beyond = is_ahead ? 1 : -1;
    t->lines -= is_ahead ? TRANSMISSION_LINES_MOST : -TRANSMISSION_LINES_MOST;
    t->reference_q32 -= is_ahead ? most_q32 : -most_q32;
    t->expected_q32 -= is_ahead ? most_q32 : -most_q32;
}

/* The gate moves on by a line, the way it turns. */
static void add_step(transmission_t *t)
{
    uint32_t room = t->step_under - t->step_over;
    if (t->gate.sense > 0) {
        bool carries = t->remainder >= room;
        t->remainder = carries ? t->remainder - room : t->remainder + t->step_over;
        t->lines += (int32_t)t->step_lines + carries;
    } else {
        bool borrows = t->remainder < t->step_over;
        t->remainder = borrows ? t->remainder + room : t->remainder - t->step_over;
        t->lines -= (int32_t)t->step_lines + borrows;
    }
}

/* Gate minus denser train, in lines of the latter, when that has gone on by `passed` of a line. */
static int64_t difference_q32(const transmission_t *t, int64_t passed_q32)
{
    return (int64_t)t->lines * ONE_Q32 + fraction_q32(t, t->remainder) -
           t->dense.sense * passed_q32;
}

/* Lines that a gate pulse stands for: as many as the other train has moved on by. */
static uint8_t judge_gate(transmission_t *t, int64_t passed_q32)
{
    int64_t  moved_q32 = t->gate.sense * (t->reference_q32 - difference_q32(t, passed_q32));
    uint64_t advance = moved_q32 < 0 ? 0u : (uint64_t)moved_q32 >> t->judge_shift;
    return pulse_judge(&t->gate, advance > UINT32_MAX ? UINT32_MAX : (uint32_t)advance,
                       t->judge_line);
}

/* ---- points ---- */

/* Where the shafts have parted by more than can be told: at the end of the range, on that side. */
static int64_t limit_nas(const transmission_t *t, int64_t whole)
{
    if (t->beyond != 0) {
        return t->beyond > 0 ? INT64_MAX : -INT64_MAX;
    }
    if (whole >= t->lines_most) {
        return INT64_MAX;
    }
    return whole <= -t->lines_most ? -INT64_MAX : 0;
}

static int64_t to_nas(const transmission_t *t, int64_t lines_q32)
{
    uint32_t rest = (uint32_t)(uint64_t)lines_q32;
    int64_t  whole = (lines_q32 - (int64_t)rest) / ONE_Q32;
    int64_t  nas = limit_nas(t, whole);
    if (nas == 0) {
        uint64_t line = (uint64_t)t->line_nas;
        uint64_t part = (line >> 32) * rest + (((line & UINT32_MAX) * rest) >> 32);
        nas = whole * t->line_nas + (int64_t)part;
    }
    return t->gate_is_output ? nas : -nas;
}

/* The phase within a line says nothing of whole lines: the nearest one is taken. */
static int64_t unwrap(transmission_t *t, int64_t difference)
{
    uint32_t phase = (uint32_t)(uint64_t)difference;
    uint32_t turned = phase - t->phase_q32;
    t->phase_q32 = phase;
    t->unwrapped_q32 += turned < UINT32_C(1) << 31 ? (int64_t)turned : (int64_t)turned - ONE_Q32;
    return t->unwrapped_q32;
}

/* A lag of the gate, from the middle of its range. */
static int64_t lag_in_lines(const transmission_t *t, uint32_t lag_q32, int8_t sense)
{
    return sense * (ONE_Q32 / 2 - (int64_t)lag_q32) * (int64_t)t->meter.dense_divider;
}

static bool compare_phases(transmission_t *t, uint8_t lines, uint32_t ticks, int64_t *value)
{
    int32_t  since_ticks = (int32_t)(ticks - t->dense.ticks);
    uint32_t lag_q32 = 0u;
    if (!phase_meter_on_gate(&t->meter, lines, since_ticks)) {
        return false;
    }
    bool has_lag = t->config.method == TRANSMISSION_PHASE_DIGITAL
                       ? phase_meter_digital(&t->meter, since_ticks, &lag_q32)
                       : phase_meter_analog(&t->meter, &lag_q32);
    *value = lag_in_lines(t, lag_q32, t->gate.sense);
    return has_lag;
}

/* What the method makes of the gate's line now; false if nothing. */
static bool measure(transmission_t *t, uint8_t lines, uint32_t ticks, uint8_t dense_lines,
                    int64_t *value)
{
    switch (t->config.method) {
    case TRANSMISSION_DIRECT:
        *value = difference_q32(t, dense_lines * (ONE_Q32 / 2));
        return true;
    case TRANSMISSION_PHASE_SUBDIVIDED:
        *value = unwrap(t, t->reference_q32);
        return true;
    case TRANSMISSION_PHASE_DIGITAL:
    case TRANSMISSION_PHASE_ANALOG:
        return compare_phases(t, lines, ticks, value);
    case TRANSMISSION_SUBDIVIDED:
    default:
        *value = t->reference_q32;
        return true;
    }
}

/* ---- pulses ---- */

/* Nothing that was is to be compared with what comes. */
static void forget_phase(transmission_t *t)
{
    t->has_reference = false;
    pulse_judge_forget(&t->gate);
    phase_meter_init(&t->meter, t->meter.dense_divider, t->meter.gate_divider,
                     t->meter.time_constant_ticks);
}

/* True if the shaft still turns as before; when it has just turned back, it is at the same line. */
static bool keeps_sense(transmission_t *t, int8_t sense)
{
    if (t->gate.sense == sense) {
        return true;
    }
    t->gate.sense = sense;
    forget_phase(t);
    return false;
}

static void count_lines(transmission_t *t, uint8_t lines)
{
    for (uint8_t i = 0u; i < lines; ++i) {
        add_step(t);
    }
    if (transmission_gate_is_full(t)) {
        transmission_gate_shift_zero(t);
    }
    t->gate.line += t->gate.sense * lines;
}

static void release(transmission_t *t)
{
    if (t->has_held) {
        t->ready[t->ready_count] = t->held;
        ++t->ready_count;
    }
    t->has_held = false;
}

/* Of two pulses for one line the one that comes nearer to what was expected is kept. */
static bool is_nearer(const transmission_t *t, int64_t difference)
{
    int64_t early = t->reference_q32 - t->expected_q32;
    int64_t late = difference - t->expected_q32;
    return (late < 0 ? -late : late) < (early < 0 ? -early : early);
}

/* Part of an interval of the denser train that had passed; below 0 where its begin was mended. */
static int64_t passed_q32(const transmission_t *t, uint32_t ticks, uint32_t interval_ticks)
{
    uint32_t since = ticks - t->dense.ticks;
    if (interval_ticks == 0u) {
        return 0;
    }
    if (since > INT32_MAX) {
        return -(int64_t)(((uint64_t)(t->dense.ticks - ticks) << 32) / interval_ticks);
    }
    return (int64_t)(((uint64_t)since << 32) / interval_ticks);
}

/* Count a gate pulse that came while the denser train moved on by `dense_lines` in `interval`. */
static void place(transmission_t *t, uint8_t i, uint32_t interval_ticks, uint8_t dense_lines)
{
    uint32_t ticks = t->pending_ticks[i];
    int64_t  passed = passed_q32(t, ticks, interval_ticks) * dense_lines;
    uint8_t  lines = keeps_sense(t, t->pending_sense[i]) ? 1u : 0u;
    bool     replaces = false;
    if (t->has_reference) {
        lines = judge_gate(t, passed);
        replaces = lines == 0u;
        if (replaces && !is_nearer(t, difference_q32(t, passed))) {
            return;
        }
    }
    if (!replaces) {
        release(t);
        count_lines(t, lines);
        t->expected_q32 = t->has_reference ? t->reference_q32 : difference_q32(t, passed);
    }
    t->reference_q32 = difference_q32(t, passed);
    t->has_reference = true;
    int64_t value = 0;
    t->has_held = measure(t, lines, ticks, dense_lines, &value);
    t->held =
        (transmission_point_t){.delta_nas = to_nas(t, value), .line = t->gate.line, .ticks = ticks};
    t->held_is_fresh = true;
}

void transmission_gate_give_up(transmission_t *t)
{
    for (uint8_t i = 0u; i < t->pending; ++i) {
        count_lines(t, keeps_sense(t, t->pending_sense[i]) ? 1u : 0u);
    }
    t->pending = 0u;
    release(t);
    forget_phase(t);
}

void transmission_gate_on_pulse(transmission_t *t, uint32_t ticks, int8_t sense)
{
    ++t->gate.counters.pulses;
    if (t->dense.sense == 0) {
        return; /* nothing to compare it with yet */
    }
    if (t->pending == TRANSMISSION_PENDING) {
        transmission_gate_give_up(t);
    }
    t->pending_ticks[t->pending] = ticks;
    t->pending_sense[t->pending] = sense;
    ++t->pending;
}

void transmission_gate_place(transmission_t *t, uint32_t interval_ticks, uint8_t dense_lines)
{
    for (uint8_t i = 0u; i < t->pending; ++i) {
        place(t, i, interval_ticks, dense_lines);
    }
    t->pending = 0u;
}
