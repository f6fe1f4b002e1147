#include "comp/phase_meter.h"

#define ONE_Q31   (UINT32_C(1) << 31)
#define LN2_Q31   UINT32_C(1488522236)
#define LOG2E_Q31 UINT32_C(3098164010)
#define TERMS     10u
#define WARM_UP   8u

void phase_meter_init(phase_meter_t *m, uint32_t dense_divider, uint32_t gate_divider,
                      uint32_t time_constant_ticks)
{
    *m = (phase_meter_t){
        .dense_divider = dense_divider,
        .gate_divider = gate_divider,
        .time_constant_ticks = time_constant_ticks,
        .dense_left = (dense_divider + 1u) / 2u,
        .gate_left = gate_divider,
        .needle_q31 = ONE_Q31 / 2u,
    };
}

static uint32_t times_q31(uint32_t a, uint32_t b_q31)
{
    return (uint32_t)(((uint64_t)a * b_q31) >> 31);
}

/* e^(-ticks / time constant): halves, and what is left of one by the series of e^-x. */
static uint32_t decay_q31(uint32_t ticks, uint32_t time_constant_ticks)
{
    uint64_t halvings_q31 = (uint64_t)ticks * LOG2E_Q31 / time_constant_ticks;
    uint64_t halvings = halvings_q31 >> 31;
    if (halvings > 31u) {
        return 0u;
    }
    uint32_t x_q31 = times_q31((uint32_t)(halvings_q31 & (ONE_Q31 - 1u)), LN2_Q31);
    uint32_t sum_q31 = ONE_Q31;
    for (uint32_t i = TERMS; i > 0u; --i) {
        sum_q31 = ONE_Q31 - times_q31(sum_q31, x_q31) / i;
    }
    return sum_q31 >> halvings;
}

static void follow(phase_meter_t *m, uint32_t ticks)
{
    uint32_t left_q31 = decay_q31(ticks, m->time_constant_ticks);
    m->needle_q31 = m->is_set ? ONE_Q31 - times_q31(ONE_Q31 - m->needle_q31, left_q31)
                              : times_q31(m->needle_q31, left_q31);
    m->needle_ticks += ticks;
}

/* The needle follows what the flip-flop has shown until now. */
static void move_needle(phase_meter_t *m, uint64_t ticks)
{
    if (ticks < m->needle_ticks) {
        return; /* a missing pulse was put where it must have been: before this one */
    }
    while (ticks - m->needle_ticks > UINT32_MAX) {
        follow(m, UINT32_MAX);
    }
    follow(m, (uint32_t)(ticks - m->needle_ticks));
}

static void on_divided_dense(phase_meter_t *m, uint64_t ticks)
{
    if (m->has_set) {
        m->period_ticks = ticks - m->set_ticks;
        move_needle(m, ticks);
    } else {
        m->needle_ticks = ticks;
        m->warm_ticks = ticks;
    }
    m->set_ticks = ticks;
    m->has_set = true;
    m->is_set = true;
}

void phase_meter_on_dense(phase_meter_t *m, uint32_t lines, uint32_t interval_ticks)
{
    if (!m->has_begun) {
        return;
    }
    uint32_t left = lines;
    m->now_ticks += interval_ticks;
    while (left >= m->dense_left) {
        left -= m->dense_left;
        m->dense_left = m->dense_divider;
        on_divided_dense(m, m->now_ticks - (uint64_t)interval_ticks * left / lines);
    }
    m->dense_left -= left;
}

void phase_meter_mend_dense(phase_meter_t *m, uint32_t shift_ticks)
{
    m->now_ticks += shift_ticks;
    if (m->has_set && m->dense_left == m->dense_divider) {
        m->set_ticks += shift_ticks;
        m->period_ticks += m->period_ticks == 0u ? 0u : shift_ticks;
    }
}

static uint64_t time_of(const phase_meter_t *m, int32_t since_ticks)
{
    return m->now_ticks + (uint64_t)(int64_t)since_ticks;
}

bool phase_meter_on_gate(phase_meter_t *m, uint32_t lines, int32_t since_ticks)
{
    m->has_begun = true;
    if (lines < m->gate_left) {
        m->gate_left -= lines;
        return false;
    }
    uint32_t over = (lines - m->gate_left) % m->gate_divider;
    m->gate_left = m->gate_divider - over;
    if (m->has_set) {
        move_needle(m, time_of(m, since_ticks));
    }
    m->is_set = false;
    return over == 0u;
}

bool phase_meter_digital(const phase_meter_t *m, int32_t since_ticks, uint32_t *lag_q32)
{
    uint64_t period = m->period_ticks;
    if (period == 0u) {
        return false;
    }
    uint64_t lag = (time_of(m, since_ticks) - m->set_ticks) % period;
    while (period > UINT32_MAX) {
        period /= 2u;
        lag /= 2u;
    }
    *lag_q32 = (uint32_t)((lag << 32) / period);
    return true;
}

bool phase_meter_analog(const phase_meter_t *m, uint32_t *lag_q32)
{
    if (!m->has_set ||
        m->needle_ticks - m->warm_ticks < (uint64_t)WARM_UP * m->time_constant_ticks) {
        return false;
    }
    *lag_q32 = m->needle_q31 == ONE_Q31 ? UINT32_MAX : m->needle_q31 << 1;
    return true;
}
