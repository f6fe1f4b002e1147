#include "comp/pulse_judge.h"

/* A line was found: what was in doubt before it was none. */
static void settle(pulse_train_t *train)
{
    train->counters.extra += train->doubtful != 0u;
    train->rejected = 0u;
    train->doubtful = 0u;
}

/* The pulses that were left out were lines after all: the shaft has changed its speed, or leapt. */
static uint8_t slip(pulse_train_t *train)
{
    uint8_t left_out = train->rejected;
    uint8_t lines = (uint8_t)(1u + left_out + (train->doubtful != 0u));
    train->counters.extra -= left_out;
    train->rejected = 0u;
    train->doubtful = 0u;
    train->steady = 0u;
    ++train->counters.slips;
    return lines;
}

static uint8_t reject(pulse_train_t *train)
{
    if (train->rejected == PULSE_REJECTED_MAX) {
        return slip(train);
    }
    ++train->rejected;
    ++train->counters.extra;
    return 0u;
}

/*
 * An advance between two lines: a pulse without a line, where one or more are missing; or the shaft
 * has changed its speed. The next pulse tells: a line follows soon upon the one without.
 */
static uint8_t doubt(pulse_train_t *train, uint32_t advance)
{
    if (train->rejected != 0u || train->doubtful != 0u) {
        return slip(train);
    }
    train->doubtful = advance;
    return 0u;
}

static bool is_refuted(const pulse_train_t *train, uint32_t advance, uint32_t soon)
{
    return train->doubtful != 0u && advance - train->doubtful >= soon;
}

uint8_t pulse_judge(pulse_train_t *train, uint32_t advance, uint32_t line)
{
    uint32_t slack = line / 4u;
    if (advance < line - slack) {
        return reject(train);
    }
    if (advance <= line + slack) {
        settle(train);
        return 1u;
    }
    uint32_t lines = advance / line;
    uint32_t over = advance % line;
    if (over > line - slack) {
        ++lines;
        over = 0u;
    }
    if (lines > PULSE_MISSING_MAX || is_refuted(train, advance, line - slack)) {
        return slip(train);
    }
    if (over > slack) {
        return doubt(train, advance);
    }
    train->counters.missing += lines - 1u;
    settle(train);
    return (uint8_t)lines;
}

static bool is_even(uint32_t interval_ticks, uint32_t before_ticks)
{
    uint32_t slack = before_ticks / 4u;
    return interval_ticks >= before_ticks - slack &&
           interval_ticks - before_ticks + slack <= 2u * slack;
}

static void learn(pulse_train_t *train, uint32_t period_ticks)
{
    train->period_ticks = period_ticks;
    if (period_ticks > UINT32_MAX >> 4) {
        train->mean_q4 = UINT32_MAX;
        train->steady = 0u;
    } else if (train->steady == 0u) {
        train->mean_q4 = period_ticks << 4;
    } else {
        train->mean_q4 += (period_ticks << 2) - (train->mean_q4 >> 2);
    }
}

/* The mean tells more where the lines are uneven, the last line where the speed changes. */
uint8_t pulse_judge_ticks(pulse_train_t *train, uint32_t interval_ticks)
{
    uint32_t mean_ticks = train->mean_q4 >> 4;
    uint8_t  lines = 1u;
    bool     even = train->period_ticks != 0u && (is_even(interval_ticks, train->period_ticks) ||
                                                  is_even(interval_ticks, mean_ticks));
    if (even) {
        settle(train);
        train->steady = train->steady < PULSE_STEADY ? (uint8_t)(train->steady + 1u) : PULSE_STEADY;
    } else if (train->steady == PULSE_STEADY && mean_ticks != 0u) {
        lines = pulse_judge(train, interval_ticks, mean_ticks);
    } else {
        train->steady = 0u;
    }
    if (lines != 0u) {
        learn(train, lines == 1u ? interval_ticks : interval_ticks / lines); /* dividing is slow */
    }
    return lines;
}

void pulse_judge_forget(pulse_train_t *train)
{
    train->period_ticks = 0u;
    train->mean_q4 = 0u;
    train->steady = 0u;
    train->rejected = 0u;
    train->doubtful = 0u;
}
