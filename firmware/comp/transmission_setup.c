#include "comp/transmission_gate.h"

#define ONE_Q32      UINT64_C(4294967296)
#define LINES_MAX    (UINT32_C(1) << 24)
#define STEP_MAX     (UINT32_C(1) << 20) /* denser train's lines in a gate line */
#define FRACTION_MAX INT32_MAX
#define LINES_LEAST  4u /* of the denser train in a period of comparison */
#define TURN_NAS     UINT64_C(1296000000000000)
#define LINE_NAS_MIN INT64_C(1000000) /* so that its rounding does not show */
#define JUDGE_BITS   24

static uint64_t common_divisor(uint64_t a, uint64_t b)
{
    while (b != 0u) {
        uint64_t rest = a % b;
        a = b;
        b = rest;
    }
    return a;
}

/* a * b / c without what would not fit into 64 bits on the way; c ≤ 2^62, result ≤ 2^63. */
static uint64_t scaled(uint64_t a, uint32_t b, uint64_t c)
{
    uint64_t whole = 0u;
    uint64_t rest = 0u;
    for (uint32_t bit = UINT32_C(1) << 31; bit != 0u; bit >>= 1) {
        whole *= 2u;
        rest *= 2u;
        if ((b & bit) != 0u) {
            whole += a / c;
            rest += a % c;
        }
        whole += rest / c;
        rest %= c;
    }
    return whole;
}

static int check(const transmission_config_t *config)
{
    if (config->lines1 == 0u || config->lines1 > LINES_MAX || config->lines2 == 0u ||
        config->lines2 > LINES_MAX) {
        return TRANSMISSION_ERR_LINES;
    }
    if (config->ratio_over == 0u || config->ratio_under == 0u) {
        return TRANSMISSION_ERR_RATIO;
    }
    if (config->method > TRANSMISSION_PHASE_ANALOG) {
        return TRANSMISSION_ERR_METHOD;
    }
    if (config->meter_ticks == 0u) {
        return TRANSMISSION_ERR_METER;
    }
    return TRANSMISSION_OK;
}

/* A gate line in lines of the denser train, to as many bits as the judge can work with. */
static void set_judge(transmission_t *t, uint32_t over, uint32_t under)
{
    uint64_t line = scaled(ONE_Q32, over, under);
    for (t->judge_shift = 0u; line >> t->judge_shift >= UINT64_C(1) << JUDGE_BITS;) {
        ++t->judge_shift;
    }
    t->judge_line = (uint32_t)(line >> t->judge_shift);
}

/* The dividers' range is of no concern to the other methods. */
static uint32_t range_of(const transmission_config_t *config, uint64_t over)
{
    if (config->range != 0u && config->method >= TRANSMISSION_PHASE_DIGITAL) {
        return config->range;
    }
    return over >= LINES_LEAST ? 1u : LINES_LEAST;
}

/* over : under are pulses of the denser train to pulses of the gate. */
static int set_step(transmission_t *t, uint64_t over, uint64_t under)
{
    uint64_t divisor = common_divisor(over, under);
    over /= divisor;
    under /= divisor;
    if (over > FRACTION_MAX || over / under >= STEP_MAX) {
        return TRANSMISSION_ERR_RANGE;
    }
    uint32_t range = range_of(&t->config, over);
    if (over > FRACTION_MAX / range) {
        return TRANSMISSION_ERR_METER;
    }
    t->step_lines = (uint32_t)(over / under);
    t->step_over = (uint32_t)(over % under);
    t->step_under = (uint32_t)under;
    t->under_inverse = UINT64_MAX / under;
    set_judge(t, (uint32_t)over, (uint32_t)under);
    phase_meter_init(&t->meter, (uint32_t)over * range, (uint32_t)under * range,
                     t->config.meter_ticks);
    return TRANSMISSION_OK;
}

int transmission_init(transmission_t *t, const transmission_config_t *config)
{
    *t = (transmission_t){.config = *config};
    int error = check(config);
    if (error != TRANSMISSION_OK) {
        return error;
    }
    uint64_t input = (uint64_t)config->lines1 * config->ratio_over;
    uint64_t output = (uint64_t)config->lines2 * config->ratio_under;
    t->gate_is_output = input >= output;
    if (t->gate_is_output) {
        error = set_step(t, input, output);
        t->line_nas = (int64_t)scaled(TURN_NAS, config->ratio_under, input);
    } else {
        error = set_step(t, output, input);
        t->line_nas = (int64_t)(TURN_NAS / config->lines2);
    }
    uint64_t most = t->line_nas == 0 ? 0u : (uint64_t)INT64_MAX / (uint64_t)t->line_nas - 1u;
    t->lines_most = most < TRANSMISSION_LINES_MOST ? (int32_t)most : TRANSMISSION_LINES_MOST;
    return error == TRANSMISSION_OK && t->line_nas < LINE_NAS_MIN ? TRANSMISSION_ERR_RANGE : error;
}
