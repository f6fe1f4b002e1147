/*
 * Every interleaving of the edge interrupt with a task-side call: an edge, or two, just before
 * every single memory access of latch.c. Whatever the instant, the outcome has to be the one of an
 * edge before the whole call or of one after it: so no record is torn, lost or doubled uncounted.
 */
/* LINK: firmware/input/latch.c tests/support/fake_critical.c tests/support/interrupt_at_access.c */
/* CFLAGS: -fno-sanitize=all -fsanitize=thread */
#include <string.h>

#include "fake_critical.h"
#include "input/latch.h"
#include "interrupt_at_access.h"
#include "unity.h"

#define EDGE_TICKS 1000u /* of the first edge of the interrupt */
#define EDGE_STEP  3u
#define ACCESS_MAX 200u

/* All that there is to be seen of a latch after a call. */
typedef struct {
    latch_counters_t counters;
    latch_record_t   kept;
    latch_record_t   ready;
    latch_record_t   taken; /* what latch_take() gave */
    latch_counters_t told;  /* what latch_counters() gave */
    uint32_t         changed_ticks;
    uint32_t         answer; /* of the other calls */
    latch_phase_t    phase;
    bool             level;
    bool             has_ready;
} outcome_t;

/* A call of the task, with a clock that was read before, between or after the edges. */
typedef void call_t(uint32_t now_ticks, outcome_t *outcome);

/* What the latch has been through when the call begins. */
typedef void past_t(void);

static latch_t  latch;
static uint32_t edge_ticks;
static unsigned outcomes_checked;
static unsigned outcomes_wrong;
static unsigned accesses_unmasked;

static latch_config_t config;

void setUp(void)
{
    fake_critical_reset(interrupt_on_unmask);
    outcomes_checked = 0u;
    outcomes_wrong = 0u;
    accesses_unmasked = 0u;
}

void tearDown(void)
{
    fake_critical_verify();
}

/* Position and time of an edge belong together. */
static int32_t position_at(uint32_t ticks)
{
    return (int32_t)(~ticks * 2654435761u);
}

static void edge_at(uint32_t ticks)
{
    latch_on_edge(&latch, ticks, position_at(ticks));
}

static void interrupt(unsigned number)
{
    edge_at(edge_ticks + number * EDGE_STEP);
}

/* ---- calls ---- */

static void call_arm(uint32_t now_ticks, outcome_t *outcome)
{
    (void)now_ticks;
    (void)outcome;
    latch_arm(&latch, &config);
}

static void call_arm_free(uint32_t now_ticks, outcome_t *outcome)
{
    (void)now_ticks;
    outcome->answer = latch_arm_free(&latch, &config);
}

static void call_disarm(uint32_t now_ticks, outcome_t *outcome)
{
    (void)now_ticks;
    (void)outcome;
    latch_disarm(&latch);
}

static void call_disarm_settled(uint32_t now_ticks, outcome_t *outcome)
{
    (void)now_ticks;
    outcome->answer = latch_disarm_settled(&latch);
}

static void call_take_unarmed(uint32_t now_ticks, outcome_t *outcome)
{
    (void)now_ticks;
    outcome->answer = latch_take_unarmed(&latch);
}

static void call_poll_high(uint32_t now_ticks, outcome_t *outcome)
{
    (void)outcome;
    latch_poll(&latch, now_ticks, true);
}

static void call_poll_low(uint32_t now_ticks, outcome_t *outcome)
{
    (void)outcome;
    latch_poll(&latch, now_ticks, false);
}

static void call_take(uint32_t now_ticks, outcome_t *outcome)
{
    (void)now_ticks;
    outcome->answer = latch_take(&latch, &outcome->taken);
}

static void call_counters(uint32_t now_ticks, outcome_t *outcome)
{
    (void)now_ticks;
    outcome->told = latch_counters(&latch);
}

static void call_idle_ticks(uint32_t now_ticks, outcome_t *outcome)
{
    outcome->answer = latch_idle_ticks(&latch, now_ticks);
}

static void call_level(uint32_t now_ticks, outcome_t *outcome)
{
    (void)now_ticks;
    outcome->answer = latch_level(&latch);
}

static void call_is_confirming(uint32_t now_ticks, outcome_t *outcome)
{
    (void)now_ticks;
    outcome->answer = latch_is_confirming(&latch);
}

static call_t *const CALLS[] = {call_arm,           call_arm_free,       call_disarm,
                                call_poll_high,     call_poll_low,       call_take,
                                call_counters,      call_idle_ticks,     call_level,
                                call_is_confirming, call_disarm_settled, call_take_unarmed};
#define CALL_COUNT (sizeof CALLS / sizeof *CALLS)

/* ---- pasts ---- */

static void past_disarmed(void)
{
}

static void past_armed(void)
{
    latch_arm(&latch, &config);
}

static void past_touched(void)
{
    past_armed();
    edge_at(EDGE_TICKS - 10u);
}

static void past_bounced(void)
{
    past_touched();
    latch_poll(&latch, EDGE_TICKS - 8u, false);
    edge_at(EDGE_TICKS - 6u);
}

static void past_released(void)
{
    past_touched();
    latch_poll(&latch, EDGE_TICKS - 8u, false);
}

/* A record that nobody took, and with a repeated latch one more touch lost for that. */
static void past_overrun(void)
{
    past_armed();
    edge_at(EDGE_TICKS - 200u);
    latch_poll(&latch, EDGE_TICKS - 150u, true);
    edge_at(EDGE_TICKS - 100u);
    latch_poll(&latch, EDGE_TICKS - 50u, true);
}

static past_t *const PASTS[] = {past_disarmed, past_armed,    past_touched,
                                past_bounced,  past_released, past_overrun};
#define PAST_COUNT (sizeof PASTS / sizeof *PASTS)

/* ---- one scene ---- */

typedef struct {
    call_t  *call;
    past_t  *past;
    uint32_t now_ticks;
    unsigned edges;
} scene_t;

static void begin(const scene_t *scene)
{
    memset(&latch, 0, sizeof latch);
    latch_init(&latch, 3u, 0u);
    scene->past();
}

static latch_record_t record_of(const latch_edge_t *edge)
{
    return (latch_record_t){
        .ticks = edge->ticks,
        .position_counts = edge->position_counts,
        .channel = latch.channel,
        .flags = edge->flags,
    };
}

static void look(outcome_t *outcome)
{
    outcome->counters = latch.counters;
    outcome->kept = record_of(&latch.kept);
    outcome->ready = record_of(&latch.ready);
    outcome->changed_ticks = latch.changed_ticks;
    outcome->phase = latch.phase;
    outcome->level = latch.level;
    outcome->has_ready = latch.has_ready;
}

/* The scene with `before` of its edges before the call and the rest after it. */
static void play_in_turn(const scene_t *scene, unsigned before, outcome_t *outcome)
{
    memset(outcome, 0, sizeof *outcome);
    begin(scene);
    for (unsigned i = 0u; i < before; ++i) {
        interrupt(i);
    }
    scene->call(scene->now_ticks, outcome);
    for (unsigned i = before; i < scene->edges; ++i) {
        interrupt(i);
    }
    look(outcome);
}

/* The scene with its edges at those accesses. Returns how many accesses there are. */
static unsigned play_interrupted(const scene_t *scene, const unsigned *at, outcome_t *outcome)
{
    memset(outcome, 0, sizeof *outcome);
    begin(scene);
    interrupt_begin(interrupt, at, scene->edges);
    scene->call(scene->now_ticks, outcome);
    unsigned accesses = interrupt_end();
    for (unsigned i = interrupt_runs(); i < scene->edges; ++i) {
        interrupt(i);
    }
    accesses_unmasked += interrupt_unmasked_accesses();
    look(outcome);
    return accesses;
}

static bool is_same_record(const latch_record_t *a, const latch_record_t *b)
{
    return a->ticks == b->ticks && a->position_counts == b->position_counts &&
           a->channel == b->channel && a->flags == b->flags;
}

static bool is_same(const outcome_t *a, const outcome_t *b)
{
    return memcmp(&a->counters, &b->counters, sizeof a->counters) == 0 &&
           memcmp(&a->told, &b->told, sizeof a->told) == 0 && is_same_record(&a->kept, &b->kept) &&
           is_same_record(&a->ready, &b->ready) && is_same_record(&a->taken, &b->taken) &&
           a->changed_ticks == b->changed_ticks && a->answer == b->answer && a->phase == b->phase &&
           a->level == b->level && a->has_ready == b->has_ready;
}

static bool is_whole(const latch_record_t *record)
{
    return (record->ticks == 0u && record->position_counts == 0) ||
           record->position_counts == position_at(record->ticks);
}

static void judge(const scene_t *scene, const outcome_t *outcome)
{
    bool is_right = false;
    for (unsigned before = 0u; before <= scene->edges; ++before) {
        outcome_t expected;
        play_in_turn(scene, before, &expected);
        is_right = is_right || is_same(outcome, &expected);
    }
    is_right = is_right && is_whole(&outcome->kept) && is_whole(&outcome->ready) &&
               is_whole(&outcome->taken);
    ++outcomes_checked;
    outcomes_wrong += is_right ? 0u : 1u;
}

/* The scene with its edges at every access, or at every two, until past the end. */
static void sweep_scene(const scene_t *scene)
{
    outcome_t outcome;
    unsigned  accesses = ACCESS_MAX;
    for (unsigned first = 0u; first <= accesses; ++first) {
        unsigned last = scene->edges == 2u ? accesses : first;
        for (unsigned second = first; second <= last; ++second) {
            const unsigned at[INTERRUPTS_MAX] = {first, second};
            accesses = play_interrupted(scene, at, &outcome);
            TEST_ASSERT_LESS_THAN_UINT(ACCESS_MAX, accesses);
            judge(scene, &outcome);
        }
    }
}

/* Clocks read before, at and after the edges, as far as any time set may reach. */
static void sweep_clock(scene_t *scene)
{
    static const uint32_t after[] = {0xFFFFFFF0u, 0xFFFFFFFFu, 0u, 1u, 4u, 5u, 8u, 30u, 300u};
    for (size_t i = 0u; i < sizeof after / sizeof *after; ++i) {
        scene->now_ticks = EDGE_TICKS + after[i];
        sweep_scene(scene);
    }
}

static void sweep_pasts(call_t *call)
{
    for (size_t past = 0u; past < PAST_COUNT; ++past) {
        for (unsigned edges = 1u; edges <= INTERRUPTS_MAX; ++edges) {
            scene_t scene = {.call = call, .past = PASTS[past], .edges = edges};
            sweep_clock(&scene);
        }
    }
}

/* One call in every situation there is. */
static void sweep(call_t *call)
{
    edge_ticks = EDGE_TICKS;
    interrupt_watch(&latch, sizeof latch);
    for (unsigned i = 0u; i < 8u; ++i) {
        config = (latch_config_t){.repeated = (i & 1u) != 0u,
                                  .confirm_ticks = (i & 2u) != 0u ? 5u : 0u,
                                  .holdoff_ticks = (i & 4u) != 0u ? 12u : 0u};
        sweep_pasts(call);
    }
}

static void check_sweep(call_t *call)
{
    sweep(call);

    TEST_ASSERT_GREATER_THAN_UINT(1000u, outcomes_checked);
    TEST_ASSERT_EQUAL_UINT(0u, outcomes_wrong);
    TEST_ASSERT_EQUAL_UINT(0u, accesses_unmasked);
}

void test_an_edge_while_arming_is_before_or_after_it(void)
{
    check_sweep(call_arm);
}

void test_an_edge_while_arming_a_free_probe_is_before_or_after_it(void)
{
    check_sweep(call_arm_free);
}

void test_an_edge_while_disarming_is_before_or_after_it(void)
{
    check_sweep(call_disarm);
}

void test_an_edge_while_disarming_a_settled_latch_is_before_or_after_it(void)
{
    check_sweep(call_disarm_settled);
}

void test_an_edge_while_unarmed_ones_are_asked_for_is_before_or_after_it(void)
{
    check_sweep(call_take_unarmed);
}

void test_an_edge_while_polling_a_deflected_probe_is_before_or_after_it(void)
{
    check_sweep(call_poll_high);
}

void test_an_edge_while_polling_a_free_probe_is_before_or_after_it(void)
{
    check_sweep(call_poll_low);
}

void test_an_edge_while_a_record_is_taken_is_before_or_after_it(void)
{
    check_sweep(call_take);
}

void test_an_edge_while_the_counters_are_read_is_before_or_after_it(void)
{
    check_sweep(call_counters);
}

void test_an_edge_while_state_is_asked_for_is_before_or_after_it(void)
{
    check_sweep(call_idle_ticks);
    check_sweep(call_level);
    check_sweep(call_is_confirming);
}

/* ---- a whole session ---- */

#define SESSION_EDGES 2u

static unsigned       taken_count;
static latch_record_t taken_records[8];

static void take_all(void)
{
    latch_record_t record;
    while (latch_take(&latch, &record)) {
        taken_records[taken_count++] = record;
    }
}

/* A task that measures: polls, takes, looks at the counters, goes on. */
static void run_session(void)
{
    for (uint32_t now = EDGE_TICKS - 6u; now < EDGE_TICKS + 30u; now += 6u) {
        latch_poll(&latch, now, now > EDGE_TICKS);
        take_all();
        (void)latch_counters(&latch);
    }
    latch_disarm(&latch);
    take_all();
}

static void check_session(void)
{
    latch_counters_t counters = latch_counters(&latch);

    TEST_ASSERT_EQUAL_UINT(SESSION_EDGES, taken_count + counters.bounces + counters.glitches +
                                              counters.overruns + counters.unarmed);
    for (unsigned i = 0u; i < taken_count; ++i) {
        TEST_ASSERT_EQUAL_INT32(position_at(taken_records[i].ticks),
                                taken_records[i].position_counts);
        TEST_ASSERT_TRUE(i == 0u || taken_records[i].ticks != taken_records[i - 1u].ticks);
    }
}

/* Two edges at any two accesses of the session. */
static void sweep_session(void)
{
    unsigned accesses = 1000u;
    for (unsigned first = 0u; first <= accesses; ++first) {
        for (unsigned second = first; second <= accesses; ++second) {
            const unsigned at[] = {first, second};
            taken_count = 0u;
            latch_init(&latch, 0u, 0u);
            latch_arm(&latch, &config);
            interrupt_begin(interrupt, at, SESSION_EDGES);
            run_session();
            accesses = interrupt_end();
            for (unsigned i = interrupt_runs(); i < SESSION_EDGES; ++i) {
                interrupt(i);
            }
            check_session();
        }
    }
}

void test_every_edge_of_a_session_is_taken_or_counted(void)
{
    edge_ticks = EDGE_TICKS;
    for (unsigned i = 0u; i < 4u; ++i) {
        config = (latch_config_t){.repeated = (i & 1u) != 0u,
                                  .holdoff_ticks = (i & 2u) != 0u ? 12u : 0u};
        sweep_session();
    }
}

/* ---- the proof that the sweep finds what it looks for ---- */

static void check_bites(call_t *call)
{
    setUp();
    fake_critical_stop_masking();
    sweep(call);

    TEST_ASSERT_GREATER_THAN_UINT(0u, outcomes_wrong);
    TEST_ASSERT_GREATER_THAN_UINT(0u, accesses_unmasked);
}

void test_without_masking_the_sweep_finds_states_that_cannot_be(void)
{
    check_bites(call_arm);
    check_bites(call_arm_free);
    check_bites(call_poll_high);
    check_bites(call_poll_low);
}

void test_without_masking_every_call_is_found_out(void)
{
    for (size_t call = 0u; call < CALL_COUNT; ++call) {
        setUp();
        fake_critical_stop_masking();
        sweep(CALLS[call]);

        TEST_ASSERT_GREATER_THAN_UINT(0u, accesses_unmasked);
    }
}
