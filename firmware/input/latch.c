#include "input/latch.h"

#include "hal_critical.h"
#include "input/ticks.h"

void latch_init(latch_t *latch, uint8_t channel, uint8_t flags)
{
    *latch = (latch_t){
        .kept = {.flags = flags},
        .phase = LATCH_DISARMED,
        .channel = channel,
    };
}

static void count_unarmed(latch_t *latch)
{
    ++latch->counters.unarmed;
    latch->has_unarmed = true;
}

/* The next record tells of it. */
static void count_lost(latch_t *latch)
{
    ++latch->counters.overruns;
    latch->kept.flags |= LATCH_FLAG_OVERRUN;
}

/* Nobody will judge an edge that waits: it is one that found no latch. */
static void drop_kept(latch_t *latch)
{
    if (latch->phase == LATCH_CONFIRMING) {
        count_unarmed(latch);
    }
}

static void arm(latch_t *latch, const latch_config_t *config)
{
    drop_kept(latch);
    if (latch->has_ready) {
        count_lost(latch);
    }
    latch->config = *config;
    latch->phase = LATCH_ARMED;
    latch->has_ready = false;
}

void latch_arm(latch_t *latch, const latch_config_t *config)
{
    hal_critical_state_t saved = hal_critical_enter();
    arm(latch, config);
    hal_critical_exit(saved);
}

bool latch_arm_free(latch_t *latch, const latch_config_t *config)
{
    hal_critical_state_t saved = hal_critical_enter();
    bool                 is_free =
        !latch->level && latch->phase != LATCH_TOUCHED && latch->phase != LATCH_CONFIRMING;
    if (is_free) {
        arm(latch, config);
    }
    hal_critical_exit(saved);
    return is_free;
}

static void disarm(latch_t *latch)
{
    drop_kept(latch);
    if (latch->phase != LATCH_TOUCHED) {
        latch->phase = LATCH_DISARMED;
    }
}

void latch_disarm(latch_t *latch)
{
    hal_critical_state_t saved = hal_critical_enter();
    disarm(latch);
    hal_critical_exit(saved);
}

bool latch_disarm_settled(latch_t *latch)
{
    hal_critical_state_t saved = hal_critical_enter();
    bool                 is_settled = latch->phase != LATCH_CONFIRMING;
    if (is_settled) {
        disarm(latch);
    }
    hal_critical_exit(saved);
    return is_settled;
}

static void confirm(latch_t *latch)
{
    latch->phase = LATCH_HOLDING;
    if (latch->has_ready) {
        count_lost(latch);
        return;
    }
    latch->ready = latch->kept;
    latch->has_ready = true;
    latch->kept.flags &= (uint8_t)~LATCH_FLAG_OVERRUN;
}

static void keep(latch_t *latch, uint32_t ticks, int32_t position_counts)
{
    latch->kept.ticks = ticks;
    latch->kept.position_counts = position_counts;
    latch->kept.flags &= (uint8_t)~LATCH_FLAG_BOUNCED;
    latch->changed_ticks = ticks;
    latch->level = true;
    if (latch->config.confirm_ticks == 0u) {
        confirm(latch);
    } else {
        latch->phase = LATCH_CONFIRMING;
    }
}

static void count_bounce(latch_t *latch, uint32_t ticks)
{
    ++latch->counters.bounces;
    latch->kept.flags |= LATCH_FLAG_BOUNCED;
    latch->changed_ticks = ticks;
    latch->level = true;
}

static void end_holdoff(latch_t *latch, uint32_t now_ticks)
{
    if (latch->phase == LATCH_HOLDING &&
        ticks_left(now_ticks, latch->kept.ticks, latch->config.holdoff_ticks) == 0u) {
        latch->phase = latch->config.repeated ? LATCH_ARMED : LATCH_DISARMED;
    }
}

void latch_on_edge(latch_t *latch, uint32_t ticks, int32_t position_counts)
{
    end_holdoff(latch, ticks);
    switch (latch->phase) {
    case LATCH_ARMED:
        keep(latch, ticks, position_counts);
        break;
    case LATCH_CONFIRMING:
    case LATCH_HOLDING:
        count_bounce(latch, ticks);
        break;
    case LATCH_DISARMED:
    case LATCH_TOUCHED:
    default:
        count_unarmed(latch);
        latch->phase = LATCH_TOUCHED;
        break;
    }
}

/* Ticks until the level has rested long enough to be believed. */
static uint32_t confirm_left(const latch_t *latch, uint32_t now_ticks)
{
    if (latch->phase != LATCH_CONFIRMING) {
        return TICKS_NEVER;
    }
    return ticks_left(now_ticks, latch->changed_ticks, latch->config.confirm_ticks);
}

static void judge(latch_t *latch, uint32_t now_ticks)
{
    if (confirm_left(latch, now_ticks) != 0u) {
        return;
    }
    if (latch->level) {
        confirm(latch);
    } else {
        latch->phase = LATCH_ARMED;
        ++latch->counters.glitches;
    }
}

void latch_poll(latch_t *latch, uint32_t now_ticks, bool level)
{
    hal_critical_state_t saved = hal_critical_enter();
    if (level != latch->level) {
        latch->level = level;
        latch->changed_ticks = now_ticks;
    }
    if (latch->phase == LATCH_TOUCHED) {
        latch->phase = LATCH_DISARMED; /* what the edge was shows in the level */
    }
    judge(latch, now_ticks);
    end_holdoff(latch, now_ticks);
    hal_critical_exit(saved);
}

bool latch_take(latch_t *latch, latch_record_t *record)
{
    hal_critical_state_t saved = hal_critical_enter();
    bool                 taken = latch->has_ready;
    if (taken) {
        *record = (latch_record_t){
            .ticks = latch->ready.ticks,
            .position_counts = latch->ready.position_counts,
            .channel = latch->channel,
            .flags = latch->ready.flags,
        };
        latch->has_ready = false;
    }
    hal_critical_exit(saved);
    return taken;
}

void latch_count_lost(latch_t *latch)
{
    hal_critical_state_t saved = hal_critical_enter();
    count_lost(latch);
    hal_critical_exit(saved);
}

bool latch_take_unarmed(latch_t *latch)
{
    hal_critical_state_t saved = hal_critical_enter();
    bool                 came = latch->has_unarmed;
    latch->has_unarmed = false;
    hal_critical_exit(saved);
    return came;
}

uint32_t latch_idle_ticks(const latch_t *latch, uint32_t now_ticks)
{
    hal_critical_state_t saved = hal_critical_enter();
    uint32_t             idle = confirm_left(latch, now_ticks);
    bool is_timed = latch->phase == LATCH_CONFIRMING || latch->phase == LATCH_HOLDING;
    hal_critical_exit(saved);
    return is_timed && idle > TICKS_LOOK ? TICKS_LOOK : idle;
}

bool latch_level(const latch_t *latch)
{
    hal_critical_state_t saved = hal_critical_enter();
    bool                 level = latch->level;
    hal_critical_exit(saved);
    return level;
}

bool latch_is_confirming(const latch_t *latch)
{
    hal_critical_state_t saved = hal_critical_enter();
    bool                 confirming = latch->phase == LATCH_CONFIRMING;
    hal_critical_exit(saved);
    return confirming;
}

latch_counters_t latch_counters(const latch_t *latch)
{
    hal_critical_state_t saved = hal_critical_enter();
    latch_counters_t     counters = latch->counters;
    hal_critical_exit(saved);
    return counters;
}
