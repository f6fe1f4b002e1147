/*
 * The latch, in any state, in any call of the task, with an edge at any access to it: locks are in
 * balance, the first edge never moves, a record is whole, and is taken once. As the states are all
 * that there are, it holds for any sequence of calls.
 *
 * An edge comes where `latch->` stands in the source: there the copy of it in PROVEN looks for one,
 * unless it is locked out or is one itself.
 */
/* LINK: firmware/input/latch.c */
/* CBMC: --unwind 3 */
/* SED: firmware/input/latch.c: s/\blatch->/AT(latch)->/g */
/* SED: firmware/input/latch.c: 1s/^/#include "edge_at_access.h"\n/ */
/* clang-format off */
/* MUTANT: firmware/input/latch.c: latch->has_ready = false;\n    }\n    hal_critical_exit(saved);\n    return taken; => latch->has_ready = false;\n    }\n    return taken; */
/* MUTANT: firmware/input/latch.c: latch->ready = latch->kept; => latch->ready.ticks =
 * latch->kept.ticks; */
/* MUTANT: firmware/input/latch.c: latch->changed_ticks = ticks;\n    latch->level = true;\n} =>
 * latch->kept.ticks = ticks;\n    latch->level = true;\n} */
/* MUTANT: firmware/input/latch.c: };\n        latch->has_ready = false; => }; */
/* MUTANT: firmware/input/latch.c: if (latch->has_ready) {\n        count_lost(latch);\n        return; => if (false) {\n        return; */
/* MUTANT: firmware/input/latch.c: if (latch->has_ready) {\n        count_lost(latch);\n    } => (void)0; */
/* MUTANT: firmware/input/latch.c: ++latch->counters.overruns;\n    latch->kept.flags |= LATCH_FLAG_OVERRUN; => ++latch->counters.overruns; */
/* MUTANT: firmware/input/latch.c: if (latch->phase == LATCH_CONFIRMING) { => if (false) { */
/* MUTANT: firmware/input/latch.c: latch->phase != LATCH_CONFIRMING;\n    if (is_settled) => true;\n    if (is_settled) */
/* MUTANT: firmware/input/latch.c: hal_critical_state_t saved = hal_critical_enter();\n    bool                 taken => hal_critical_state_t saved = 0;\n    bool                 taken */
/* MUTANT: firmware/input/latch.c: !latch->level && latch->phase != LATCH_TOUCHED => !latch->level */
/* MUTANT: firmware/input/latch.c: latch->phase = LATCH_TOUCHED; => (void)0; */
/* clang-format on */
#include "any.h"
#include "edge_at_access.h"
#include "hal_critical.h"
#include "input/latch.h"

static latch_t      latch;
static bool         is_locked;
static bool         is_in_edge;
static uint8_t      locks;
static uint8_t      edges;
static latch_edge_t first; /* of the present touch */
static latch_edge_t whole; /* the confirmed touch that waits */

hal_critical_state_t hal_critical_enter(void)
{
    hal_critical_state_t saved = is_locked;
    PROVE(locks < UINT8_MAX);
    is_locked = true;
    locks++;
    return saved;
}

void hal_critical_exit(hal_critical_state_t saved)
{
    PROVE(is_locked && locks > 0u);
    is_locked = saved != 0;
    locks--;
}

static bool is_same(const latch_edge_t *a, const latch_edge_t *b)
{
    return a->ticks == b->ticks && a->position_counts == b->position_counts &&
           (a->flags & (uint8_t)~LATCH_FLAG_BOUNCED) == (b->flags & (uint8_t)~LATCH_FLAG_BOUNCED);
}

static bool is_touching(void)
{
    return latch.phase == LATCH_CONFIRMING || latch.phase == LATCH_HOLDING;
}

/* Between calls and edges. */
static void prove_first_edge_stays(bool was_touching)
{
    if (was_touching && is_touching()) {
        PROVE(latch.kept.ticks == first.ticks);
        PROVE(latch.kept.position_counts == first.position_counts);
    }
}

static void edge(void)
{
    bool         was_touching = is_touching();
    bool         had_ready = latch.has_ready;
    uint16_t     unarmed = latch.counters.unarmed;
    latch_edge_t came = {.ticks = nondet_u32(), .position_counts = nondet_i32()};

    is_in_edge = true;
    latch_on_edge(&latch, came.ticks, came.position_counts);
    is_in_edge = false;
    PROVE(IMPLIES(latch.counters.unarmed != unarmed, latch.phase == LATCH_TOUCHED));
    /* A hold-off that was over lets this edge begin a touch. */
    bool is_new =
        latch.kept.ticks == came.ticks && latch.kept.position_counts == came.position_counts;
    PROVE(latch.kept.ticks == first.ticks || is_new || !was_touching);
    if (is_new) {
        first = latch.kept;
    }
    prove_first_edge_stays(was_touching);
    if (had_ready) {
        PROVE(latch.has_ready && is_same(&latch.ready, &whole));
    } else if (latch.has_ready) {
        PROVE(latch.ready.ticks == came.ticks);
        PROVE(latch.ready.position_counts == came.position_counts);
        whole = latch.ready;
    }
}

void edge_at_access(void)
{
    if (!is_locked && !is_in_edge && edges > 0u && nondet_bool()) {
        edges--;
        edge();
    }
}

static void begin_in_any_state(void)
{
    latch_t any;
    ASSUME(any.phase <= LATCH_TOUCHED && any.channel <= LATCH_CHANNEL_MAX);
    latch = any;
    first = latch.kept;
    whole = latch.ready;
    edges = 2u;
}

static void prove_take(void)
{
    latch_record_t record;
    bool           had_ready = latch.has_ready;
    if (latch_take(&latch, &record)) {
        PROVE(record.ticks == whole.ticks && record.position_counts == whole.position_counts);
        PROVE(record.flags == whole.flags && record.channel == latch.channel);
        PROVE(!latch.has_ready || edges < 2u);
    } else {
        PROVE(!had_ready);
    }
}

static void prove_poll(void)
{
    bool     was_touching = is_touching();
    bool     had_ready = latch.has_ready;
    uint16_t overruns = latch.counters.overruns;
    latch_poll(&latch, nondet_u32(), nondet_bool());
    prove_first_edge_stays(was_touching && edges == 2u);
    if (had_ready) {
        PROVE(latch.has_ready && is_same(&latch.ready, &whole));
    } else if (latch.has_ready && edges == 2u) {
        PROVE(is_same(&latch.ready, &first));
    }
    PROVE(IMPLIES(edges == 2u, (uint16_t)(latch.counters.overruns - overruns) <= had_ready));
}

/* What disarming or arming takes from an edge that waits is counted. */
static void prove_dropped(bool was_confirming, uint16_t unarmed)
{
    uint16_t more = (uint16_t)(latch.counters.unarmed - unarmed);
    PROVE(more >= (was_confirming ? 1u : 0u));
    PROVE(IMPLIES(edges == 2u, more == (was_confirming ? 1u : 0u)));
}

/* A record that nobody took is counted, and what comes next tells of it. */
static void prove_arm(void)
{
    latch_config_t config;
    bool           had_ready = latch.has_ready;
    bool           was_confirming = latch.phase == LATCH_CONFIRMING;
    uint16_t       overruns = latch.counters.overruns;
    uint16_t       unarmed = latch.counters.unarmed;
    latch_arm(&latch, &config);
    if (edges == 2u) {
        PROVE(latch.phase == LATCH_ARMED && !latch.has_ready);
        PROVE((uint16_t)(latch.counters.overruns - overruns) == (had_ready ? 1u : 0u));
        PROVE(IMPLIES(had_ready, (latch.kept.flags & LATCH_FLAG_OVERRUN) != 0u));
    }
    prove_dropped(was_confirming, unarmed);
}

static void prove_disarm(void)
{
    bool     was_touched = latch.phase == LATCH_TOUCHED;
    bool     was_confirming = latch.phase == LATCH_CONFIRMING;
    uint16_t unarmed = latch.counters.unarmed;
    latch_disarm(&latch);
    PROVE(edges < 2u || latch.phase == (was_touched ? LATCH_TOUCHED : LATCH_DISARMED));
    prove_dropped(was_confirming, unarmed);
}

/* Nothing that waits is dropped, whenever it came. */
static void prove_disarm_settled(void)
{
    bool     was_confirming = latch.phase == LATCH_CONFIRMING;
    uint16_t unarmed = latch.counters.unarmed;
    bool     is_disarmed = latch_disarm_settled(&latch);
    PROVE(IMPLIES(was_confirming, !is_disarmed && latch.phase == LATCH_CONFIRMING));
    PROVE(IMPLIES(!is_disarmed, latch.counters.unarmed == unarmed || edges < 2u));
    PROVE(IMPLIES(edges == 2u, latch.counters.unarmed == unarmed));
    PROVE(IMPLIES(is_disarmed, latch.phase == LATCH_DISARMED || latch.phase == LATCH_TOUCHED));
    PROVE(IMPLIES(is_disarmed && latch.phase == LATCH_DISARMED, latch.counters.unarmed == unarmed));
}

/* Armed only over a free probe; whatever came before, and whatever comes later, is not lost. */
static void prove_arm_free(void)
{
    latch_config_t config;
    bool was_free = !latch.level && latch.phase != LATCH_TOUCHED && latch.phase != LATCH_CONFIRMING;
    uint16_t unarmed = latch.counters.unarmed;
    bool     is_armed = latch_arm_free(&latch, &config);
    if (edges == 2u) {
        PROVE(is_armed == was_free);
        PROVE(IMPLIES(is_armed, latch.phase == LATCH_ARMED && !latch.has_ready));
    }
    PROVE(IMPLIES(is_armed, was_free && latch.counters.unarmed == unarmed));
}

int main(void)
{
    begin_in_any_state();
    switch (nondet_u8() % 8u) {
    case 0u:
        prove_take();
        break;
    case 1u:
        prove_poll();
        break;
    case 2u:
        prove_arm();
        break;
    case 3u:
        prove_disarm();
        break;
    case 4u:
        prove_arm_free();
        break;
    case 5u:
        (void)latch_counters(&latch);
        break;
    case 6u:
        prove_disarm_settled();
        break;
    default:
        edge();
        break;
    }
    PROVE(locks == 0u && !is_locked);
    PROVE(IMPLIES(latch.has_ready && whole.ticks != latch.ready.ticks, edges == 2u));
    return 0;
}
