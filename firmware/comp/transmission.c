#include "comp/transmission.h"

#include "comp/transmission_gate.h"

/* ---- the denser train's pulses ---- */

/*
 * A pulse was left out: of it and the one that was counted for its line, the one that comes nearer
 * to what was expected is kept.
 */
static void mend_dense(transmission_t *t, uint32_t ticks)
{
    uint32_t shift = ticks - t->dense.ticks;
    uint32_t early = t->expected_ticks - t->dense.ticks;
    if (early > t->dense.period_ticks || shift >= 2u * early) {
        return; /* it was late, or not early enough */
    }
    t->dense.ticks = ticks;
    t->dense.period_ticks += shift;
    phase_meter_mend_dense(&t->meter, shift);
    if (t->held_is_fresh) {
        t->has_held = false; /* its fraction was taken of too short a line */
    }
}

/* The denser train has moved on by `lines` to `ticks`. */
static void move_dense(transmission_t *t, uint32_t ticks, uint8_t lines)
{
    uint32_t interval = ticks - t->dense.ticks;
    t->held_is_fresh = false;
    if (t->pending != 0u) {
        transmission_gate_place(t, interval, lines);
    }
    phase_meter_on_dense(&t->meter, lines, interval);
    t->lines -= t->dense.sense * lines;
    if (transmission_gate_is_full(t)) {
        transmission_gate_shift_zero(t);
    }
    t->dense.line += t->dense.sense * lines;
    t->dense.ticks = ticks;
}

/* What comes next is not compared in time with what was. A pulse that is in doubt was a line. */
static void end_stretch(transmission_t *t)
{
    if (t->dense.doubtful != 0u) {
        move_dense(t, t->dense.ticks + t->dense.doubtful, 1u);
    }
    transmission_gate_give_up(t);
    pulse_judge_forget(&t->dense);
}

static void turn_dense(transmission_t *t, uint32_t ticks, int8_t sense)
{
    end_stretch(t);
    t->dense.sense = sense;
    t->dense.ticks = ticks;
}

static void on_dense(transmission_t *t, uint32_t ticks, int8_t sense)
{
    ++t->dense.counters.pulses;
    if (sense != t->dense.sense) {
        turn_dense(t, ticks, sense);
        return;
    }
    if (t->rested) {
        t->rested = false;
        transmission_gate_give_up(t);
        move_dense(t, ticks, 1u);
        return;
    }
    uint32_t period = t->dense.period_ticks;
    uint8_t  lines = pulse_judge_ticks(&t->dense, ticks - t->dense.ticks);
    if (lines == 0u) {
        mend_dense(t, ticks);
        return;
    }
    t->expected_ticks = t->dense.ticks + lines * period;
    move_dense(t, ticks, lines);
}

/* ---- from outside ---- */

static void on_line(transmission_t *t, bool is_output, uint32_t ticks, int8_t sense)
{
    if (is_output == t->gate_is_output) {
        transmission_gate_on_pulse(t, ticks, sense);
    } else {
        on_dense(t, ticks, sense);
    }
}

static void on_index(transmission_t *t, bool is_output, int8_t sense)
{
    bool                  is_gate = is_output == t->gate_is_output;
    const pulse_train_t  *train = is_gate ? &t->gate : &t->dense;
    transmission_index_t *index = &t->index[is_output];
    uint32_t              turn = is_output ? t->config.lines2 : t->config.lines1;
    /* Of the two lines beside it the one that is lower in count, whichever way it was passed. */
    int32_t line = train->line + (is_gate ? sense * t->pending : 0) - (sense < 0);
    if (index->count != 0u && (line - index->line) % (int32_t)turn != 0) {
        ++index->slips;
    }
    index->line = line;
    ++index->count;
}

uint8_t transmission_on_pulse(transmission_t *t, uint8_t channel, uint32_t ticks)
{
    int8_t sense = (channel & TRANSMISSION_BACKWARD) != 0u ? -1 : 1;
    t->ready_count = 0u;
    switch (channel & (uint8_t)~TRANSMISSION_BACKWARD) {
    case TRANSMISSION_INPUT:
        on_line(t, false, ticks, sense);
        break;
    case TRANSMISSION_OUTPUT:
        on_line(t, true, ticks, sense);
        break;
    case TRANSMISSION_INPUT_INDEX:
        on_index(t, false, sense);
        break;
    case TRANSMISSION_OUTPUT_INDEX:
        on_index(t, true, sense);
        break;
    default:
        break;
    }
    return t->ready_count;
}

transmission_point_t transmission_point(const transmission_t *t, uint8_t i)
{
    return t->ready[i];
}

void transmission_pause(transmission_t *t)
{
    end_stretch(t);
    t->rested = true;
}

/* A train has no sense before its first pulse. */
static void restart_train(pulse_train_t *train)
{
    pulse_judge_forget(train);
    train->line = 0;
    train->sense = 0;
}

void transmission_restart(transmission_t *t)
{
    transmission_gate_give_up(t);
    restart_train(&t->gate);
    restart_train(&t->dense);
    t->remainder = 0u;
    t->lines = 0;
    t->beyond = 0;
    t->phase_q32 = 0u;
    t->unwrapped_q32 = 0;
    t->index[0] = (transmission_index_t){0};
    t->index[1] = (transmission_index_t){0};
    t->ready_count = 0u;
    t->rested = false;
}

uint8_t transmission_dense_channel(const transmission_t *t)
{
    return t->gate_is_output ? TRANSMISSION_INPUT : TRANSMISSION_OUTPUT;
}

static const pulse_train_t *train_of(const transmission_t *t, uint8_t channel)
{
    return (channel == TRANSMISSION_OUTPUT) == t->gate_is_output ? &t->gate : &t->dense;
}

pulse_counters_t transmission_counters(const transmission_t *t, uint8_t channel)
{
    return train_of(t, channel)->counters;
}

transmission_index_t transmission_index(const transmission_t *t, uint8_t channel)
{
    return t->index[channel == TRANSMISSION_OUTPUT];
}
