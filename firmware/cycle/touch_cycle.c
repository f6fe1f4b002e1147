#include "cycle/touch_cycle.h"

#include "hal_clock.h"
#include "input/ticks.h"

/*
 * However the cycle ends, the edges up to here are answered for, and nothing sets out any more: a
 * motion that nobody has begun goes, a stop stays.
 */
static void end(touch_cycle_t *cycle, touch_state_t state, touch_error_t error)
{
    cycle->result.error = error;
    cycle->state = state;
    cycle->has_request = cycle->has_request && cycle->request.kind == TOUCH_STOP;
    latch_disarm(cycle->latch);
    (void)latch_take_unarmed(cycle->latch);
}

static void ask(touch_cycle_t *cycle, touch_request_kind_t kind, int32_t target_counts,
                double feed_mm_min)
{
    cycle->request = (touch_request_t){kind, target_counts, feed_mm_min};
    cycle->has_request = true;
}

static void begin_motion(touch_cycle_t *cycle, touch_state_t state, uint32_t now_ticks)
{
    cycle->state = state;
    cycle->is_at_rest = false;
    cycle->since_ticks = now_ticks;
}

static void approach(touch_cycle_t *cycle, touch_state_t state, double feed_mm_min,
                     uint32_t now_ticks)
{
    const touch_config_t *config = &cycle->config;
    int32_t travel = config->approach_counts + cycle->sense * config->overtravel_counts;
    ask(cycle, TOUCH_MOVE, cycle->start_counts + travel, feed_mm_min);
    begin_motion(cycle, state, now_ticks);
}

static uint32_t holdoff_left(const touch_cycle_t *cycle, uint32_t now_ticks)
{
    return ticks_left(now_ticks, cycle->released_ticks, cycle->latch_config.holdoff_ticks);
}

/* A release bounces like a touch does: the level counts again once the hold-off is over. */
static void watch_release(touch_cycle_t *cycle, uint32_t now_ticks)
{
    if (!latch_level(cycle->latch) && !cycle->is_released) {
        cycle->is_released = true;
        cycle->released_ticks = now_ticks;
    }
    if (cycle->is_released && holdoff_left(cycle, now_ticks) == 0u) {
        cycle->has_bounced = true;
    }
}

static void retreat(touch_cycle_t *cycle, touch_state_t state, int32_t target_counts,
                    uint32_t now_ticks)
{
    cycle->is_released = false;
    cycle->has_bounced = false;
    ask(cycle, TOUCH_MOVE, target_counts, cycle->config.feed_mm_min);
    begin_motion(cycle, state, now_ticks);
    watch_release(cycle, now_ticks);
}

static void take_config(touch_cycle_t *cycle, const touch_config_t *config)
{
    uint32_t tick_ps = hal_clock_tick_ps();
    cycle->config = *config;
    cycle->sense = config->approach_counts > 0 ? 1 : -1;
    cycle->timeout_ticks =
        config->timeout_us == 0u ? TICKS_NEVER : ticks_from_us(config->timeout_us, tick_ps);
    cycle->settle_ticks = ticks_from_us(config->settle_us, tick_ps);
    cycle->latch_config = (latch_config_t){
        .repeated = false,
        .confirm_ticks = ticks_from_us(config->confirm_us, tick_ps),
        .holdoff_ticks = ticks_from_us(config->holdoff_us, tick_ps),
    };
}

/*
 * Edges between two cycles mean that something was hit on the way: told once, at the next start.
 * They are asked for once the latch is armed, so none comes in between.
 */
static touch_error_t arm_at_start(const touch_cycle_t *cycle, const touch_input_t *input)
{
    if (!touch_cycle_config_is_sound(&cycle->config, input->position_counts)) {
        return TOUCH_ERR_CONFIG;
    }
    bool is_armed = latch_arm_free(cycle->latch, &cycle->latch_config);
    if (latch_take_unarmed(cycle->latch)) {
        return TOUCH_ERR_UNARMED_TOUCH;
    }
    return is_armed ? TOUCH_OK : TOUCH_ERR_DEFLECTED_AT_START;
}

touch_error_t touch_cycle_start(touch_cycle_t *cycle, latch_t *latch, const touch_config_t *config,
                                const touch_input_t *input)
{
    if (cycle->has_latch) { /* nobody took it, and here it goes */
        latch_count_lost(latch);
    }
    cycle->latch = latch;
    cycle->result = (touch_result_t){.error = TOUCH_OK};
    cycle->has_request = false;
    cycle->has_latch = false;
    take_config(cycle, config);

    touch_error_t error = arm_at_start(cycle, input);
    if (error != TOUCH_OK) {
        end(cycle, TOUCH_FAILED, error);
        return error;
    }
    cycle->start_ticks = input->now_ticks;
    cycle->start_counts = input->position_counts;
    approach(cycle, TOUCH_APPROACHING, config->feed_mm_min, input->now_ticks);
    return TOUCH_OK;
}

static void poll_stop(touch_cycle_t *cycle, const touch_input_t *input)
{
    int32_t latched = cycle->result.latch.position_counts;
    if (input->is_moving) {
        return;
    }
    int32_t overtravel = cycle->sense * (input->position_counts - latched);
    if (cycle->state == TOUCH_STOPPING) {
        cycle->result.fast_overtravel_counts = overtravel;
        retreat(cycle, TOUCH_BACKING_OFF, latched - cycle->sense * cycle->config.back_off_counts,
                input->now_ticks);
    } else {
        cycle->result.overtravel_counts = overtravel;
        retreat(cycle, TOUCH_RETURNING, cycle->start_counts, input->now_ticks);
    }
}

/* The record of a fast touch is not handed out: what it tells of losses is kept for the next. */
static bool take_touch(touch_cycle_t *cycle)
{
    latch_record_t *record = &cycle->result.latch;
    bool            taken = latch_take(cycle->latch, record);
    if (taken) {
        cycle->has_lost = cycle->has_lost || (record->flags & LATCH_FLAG_OVERRUN) != 0u;
        if (cycle->has_lost) {
            record->flags |= LATCH_FLAG_OVERRUN;
        }
    }
    return taken;
}

static void poll_touch(touch_cycle_t *cycle, const touch_input_t *input)
{
    bool is_measuring = cycle->state == TOUCH_MEASURING || !cycle->config.two_touches;
    /* First shut the door, then look who is in; an edge that waits holds it open. */
    bool is_over = !input->is_moving && latch_disarm_settled(cycle->latch);

    if (take_touch(cycle)) {
        cycle->has_latch = is_measuring;
        ask(cycle, TOUCH_STOP, 0, 0.0);
        begin_motion(cycle, is_measuring ? TOUCH_MEASURED : TOUCH_STOPPING, input->now_ticks);
        cycle->is_at_rest = !input->is_moving; /* confirmed at the end of the travel */
    } else if (is_over) {
        end(cycle, TOUCH_FAILED, TOUCH_ERR_NO_TOUCH);
    }
}

static void end_retreat(touch_cycle_t *cycle, uint32_t now_ticks)
{
    if (cycle->state == TOUCH_RETURNING) {
        cycle->result.duration_ticks = ticks_elapsed(now_ticks, cycle->start_ticks);
        end(cycle, TOUCH_DONE, TOUCH_OK);
    } else if (latch_arm_free(cycle->latch, &cycle->latch_config)) {
        approach(cycle, TOUCH_MEASURING, cycle->config.measure_feed_mm_min, now_ticks);
    } /* else an edge has just come, and the next poll tells whether it was a touch */
}

/* Ticks until the present motion, or the wait for a release after it, has lasted too long. */
static uint32_t limit_left(const touch_cycle_t *cycle, uint32_t now_ticks)
{
    uint32_t settle = cycle->is_released ? TICKS_NEVER : cycle->settle_ticks;
    uint32_t limit = cycle->is_at_rest ? settle : cycle->timeout_ticks;
    return limit == TICKS_NEVER ? TICKS_NEVER : ticks_left(now_ticks, cycle->since_ticks, limit);
}

static void poll_retreat(touch_cycle_t *cycle, const touch_input_t *input)
{
    watch_release(cycle, input->now_ticks);
    if (cycle->has_bounced && latch_level(cycle->latch)) {
        ask(cycle, TOUCH_STOP, 0, 0.0);
        end(cycle, TOUCH_FAILED, TOUCH_ERR_DEFLECTED_IN_RETREAT);
        return;
    }
    if (input->is_moving) {
        return;
    }
    if (!cycle->is_at_rest) {
        cycle->is_at_rest = true;
        cycle->since_ticks = input->now_ticks;
    }
    if (cycle->has_bounced) {
        end_retreat(cycle, input->now_ticks);
    } else if (limit_left(cycle, input->now_ticks) == 0u) {
        end(cycle, TOUCH_FAILED, TOUCH_ERR_STUCK_DEFLECTED);
    }
}

static bool is_stopping(const touch_cycle_t *cycle)
{
    return cycle->state == TOUCH_STOPPING || cycle->state == TOUCH_MEASURED;
}

static bool is_retreating(const touch_cycle_t *cycle)
{
    return cycle->state == TOUCH_BACKING_OFF || cycle->state == TOUCH_RETURNING;
}

static uint32_t sooner(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

static bool is_running(const touch_cycle_t *cycle)
{
    return cycle->state != TOUCH_IDLE && cycle->state != TOUCH_DONE && cycle->state != TOUCH_FAILED;
}

touch_state_t touch_cycle_poll(touch_cycle_t *cycle, const touch_input_t *input)
{
    switch (cycle->state) {
    case TOUCH_APPROACHING:
    case TOUCH_MEASURING:
        poll_touch(cycle, input);
        break;
    case TOUCH_STOPPING:
    case TOUCH_MEASURED:
        poll_stop(cycle, input);
        break;
    case TOUCH_BACKING_OFF:
    case TOUCH_RETURNING:
        poll_retreat(cycle, input);
        break;
    case TOUCH_IDLE:
    case TOUCH_DONE:
    case TOUCH_FAILED:
    default:
        break;
    }
    if (is_running(cycle) && input->is_moving && limit_left(cycle, input->now_ticks) == 0u) {
        ask(cycle, TOUCH_STOP, 0, 0.0);
        end(cycle, TOUCH_FAILED, TOUCH_ERR_TIMEOUT);
    }
    return cycle->state;
}

bool touch_cycle_take_request(touch_cycle_t *cycle, touch_request_t *request)
{
    bool taken = cycle->has_request;
    if (taken) {
        *request = cycle->request;
        cycle->has_request = false;
    }
    return taken;
}

bool touch_cycle_take_latch(touch_cycle_t *cycle, latch_record_t *record)
{
    bool taken = cycle->has_latch;
    if (taken) {
        *record = cycle->result.latch;
        cycle->has_latch = false;
        cycle->has_lost = false;
    }
    return taken;
}

const touch_result_t *touch_cycle_result(const touch_cycle_t *cycle)
{
    return &cycle->result;
}

uint32_t touch_cycle_idle_ticks(const touch_cycle_t *cycle, uint32_t now_ticks)
{
    if (!is_running(cycle)) {
        return TICKS_NEVER;
    }
    if (cycle->is_at_rest && (is_stopping(cycle) || cycle->has_bounced)) {
        return 0u;
    }
    uint32_t wait = limit_left(cycle, now_ticks);
    /* The end of the hold-off matters to an axis at rest, and to a probe deflected by then. */
    bool is_holding = is_retreating(cycle) && cycle->is_released && !cycle->has_bounced;
    if (is_holding && (cycle->is_at_rest || latch_level(cycle->latch))) {
        wait = sooner(wait, holdoff_left(cycle, now_ticks));
    }
    return sooner(wait, latch_idle_ticks(cycle->latch, now_ticks));
}
