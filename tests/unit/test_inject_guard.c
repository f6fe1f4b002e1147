/* The guard: what is in order and armed is obeyed, everything else is counted and changes nothing.
 */
/* LINK: firmware/inject/inject_guard.c firmware/inject/inject_guard_report.c */
/* LINK: firmware/inject/inject_frame.c firmware/inject/inject_crc.c */
/* LINK: firmware/inject/inject_seal.c firmware/inject/inject_siphash.c */
#include <string.h>

#include "inject/inject_guard.h"
#include "unity.h"

#define LINES    2u
#define VALID_MS 1000u
#define SEED     12345u

static inject_guard_t guard;
static inject_order_t order;
static uint64_t       now_ms;
static uint8_t        counter; /* of the last command sent */

void setUp(void)
{
    now_ms = UINT32_MAX - 10u; /* 32 bits of the clock are too few in every test */
    counter = 0u;
    inject_guard_begin(&guard, SEED, LINES);
}

void tearDown(void)
{
}

static inject_verdict_t send_as_it_is(const inject_command_t *command)
{
    uint8_t frame[INJECT_FRAME_BYTES];
    inject_frame_put_command(command, frame);
    order = inject_guard_take(&guard, frame, INJECT_FRAME_BYTES, now_ms);
    return order.verdict;
}

/* Send with the counter one on. */
static inject_verdict_t send(inject_command_t command)
{
    ++counter;
    command.counter = counter;
    return send_as_it_is(&command);
}

static inject_verdict_t send_arm(void)
{
    return send((inject_command_t){.kind = INJECT_ARM, .valid_ms = VALID_MS});
}

static inject_verdict_t send_pulse(uint32_t width_us)
{
    return send(
        (inject_command_t){.kind = INJECT_PULSE, .line = 1u, .level = 1u, .width_us = width_us});
}

static inject_verdict_t send_train(uint16_t count, uint32_t period_us)
{
    return send((inject_command_t){.kind = INJECT_TRAIN, .count = count, .period_us = period_us});
}

static inject_command_t trigger(void)
{
    return (inject_command_t){.kind = INJECT_TRIGGER, .token = guard.token, .delay_us = 30u};
}

static void prepare(void)
{
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send_arm());
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send_pulse(100u));
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send_train(3u, 500u));
}

static void assert_refused(inject_verdict_t expected, inject_verdict_t verdict)
{
    TEST_ASSERT_EQUAL(expected, verdict);
    TEST_ASSERT_FALSE(order.has_shot);
    TEST_ASSERT_FALSE(order.has_stop);
    TEST_ASSERT_EQUAL_UINT16(1u, guard.verdicts[expected]);
}

void test_armed_and_set_it_triggers_what_was_set(void)
{
    prepare();
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send(trigger()));

    TEST_ASSERT_TRUE(order.has_shot);
    TEST_ASSERT_EQUAL_UINT8(1u, order.shot.line);
    TEST_ASSERT_EQUAL_UINT8(1u, order.shot.level);
    TEST_ASSERT_EQUAL_UINT16(3u, order.shot.count);
    TEST_ASSERT_EQUAL_UINT32(30u, order.shot.delay_us);
    TEST_ASSERT_EQUAL_UINT32(100u, order.shot.width_us);
    TEST_ASSERT_EQUAL_UINT32(500u, order.shot.period_us);
    TEST_ASSERT_EQUAL_UINT16(4u, guard.verdicts[INJECT_OBEYED]);
}

void test_what_is_set_serves_many_triggers_each_with_a_token_of_its_own(void)
{
    prepare();
    for (unsigned i = 0u; i < 1000u; ++i) {
        uint16_t token = guard.token;
        TEST_ASSERT_EQUAL(INJECT_OBEYED, send(trigger()));

        TEST_ASSERT_TRUE(order.has_shot);
        TEST_ASSERT_TRUE(guard.token != 0u && guard.token != token);
    }
}

void test_unarmed_nothing_is_set_and_nothing_triggers(void)
{
    assert_refused(INJECT_UNARMED, send_pulse(100u));
    TEST_ASSERT_EQUAL(INJECT_UNARMED, send_train(1u, 0u));
    TEST_ASSERT_EQUAL(INJECT_UNARMED, send(trigger()));
    TEST_ASSERT_FALSE(order.has_shot);
    TEST_ASSERT_EQUAL_UINT16(3u, guard.verdicts[INJECT_UNARMED]);
}

void test_wrong_token_triggers_nothing(void)
{
    prepare();
    inject_command_t forged = trigger();
    forged.token ^= 1u;
    assert_refused(INJECT_WRONG_TOKEN, send(forged));
}

void test_token_opens_one_trigger_only(void)
{
    prepare();
    inject_command_t spent = trigger();
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send(spent));

    assert_refused(INJECT_WRONG_TOKEN, send(spent));
}

void test_token_holds_until_the_last_millisecond_and_not_longer(void)
{
    prepare();
    now_ms += VALID_MS - 1u;
    TEST_ASSERT_EQUAL(INJECT_ARMED, inject_guard_state(&guard, now_ms));
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send(trigger()));

    inject_command_t late = trigger();
    now_ms += 1u;
    assert_refused(INJECT_UNARMED, send(late));
    TEST_ASSERT_EQUAL(INJECT_IDLE, inject_guard_state(&guard, now_ms));
}

void test_arming_anew_revokes_the_token_and_what_was_set(void)
{
    prepare();
    inject_command_t old = trigger();
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send_arm());

    assert_refused(INJECT_WRONG_TOKEN, send(old));
    assert_refused(INJECT_INCOMPLETE, send(trigger()));
}

void test_disarmed_stops_and_nothing_triggers(void)
{
    prepare();
    inject_command_t old = trigger();
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send((inject_command_t){.kind = INJECT_DISARM}));

    TEST_ASSERT_TRUE(order.has_stop);
    assert_refused(INJECT_UNARMED, send(old));
}

void test_a_frame_repeated_is_not_obeyed_again(void)
{
    prepare();
    inject_command_t command = trigger();
    ++counter;
    command.counter = counter;
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send_as_it_is(&command));

    assert_refused(INJECT_REPEATED, send_as_it_is(&command));
}

/* Whatever the counter has come to meanwhile, a replayed trigger triggers nothing. */
void test_a_trigger_replayed_at_any_later_counter_is_refused(void)
{
    prepare();
    inject_command_t command = trigger();
    ++counter;
    command.counter = counter;
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send_as_it_is(&command));
    for (unsigned i = 0u; i < 600u; ++i) {
        TEST_ASSERT_TRUE(send_as_it_is(&command) != INJECT_OBEYED);

        TEST_ASSERT_FALSE(order.has_shot);
        guard.wrong_tokens = 0u;      /* as if long after the one before */
        counter = guard.last_counter; /* a replay in order moves the counter on */
        TEST_ASSERT_EQUAL(INJECT_OBEYED, send_pulse(100u));
    }
}

/* A whole session, arming and all, played again as it was recorded. */
void test_a_replayed_session_triggers_nothing(void)
{
    inject_command_t session[4] = {
        {.kind = INJECT_ARM, .counter = 1u, .valid_ms = VALID_MS},
        {.kind = INJECT_PULSE, .counter = 2u, .line = 0u, .level = 1u, .width_us = 10u},
        {.kind = INJECT_TRAIN, .counter = 3u, .count = 1u},
        {.kind = INJECT_TRIGGER, .counter = 4u},
    };
    for (unsigned i = 0u; i < 4u; ++i) {
        session[3].token = guard.token;
        TEST_ASSERT_EQUAL(INJECT_OBEYED, send_as_it_is(&session[i]));
    }
    TEST_ASSERT_TRUE(order.has_shot);

    for (uint32_t seed = 1u; seed <= 100u; ++seed) {
        inject_guard_begin(&guard, seed, LINES);
        for (unsigned i = 0u; i < 4u; ++i) {
            (void)send_as_it_is(&session[i]);
        }
        TEST_ASSERT_EQUAL(INJECT_WRONG_TOKEN, order.verdict);
        TEST_ASSERT_FALSE(order.has_shot);
    }
}

void test_steps_of_1_to_127_are_in_order_and_others_are_not(void)
{
    for (unsigned step = 0u; step < 256u; ++step) {
        setUp();
        inject_command_t command = {
            .kind = INJECT_ARM, .counter = (uint8_t)step, .valid_ms = VALID_MS};
        inject_verdict_t expected = step == 0u     ? INJECT_REPEATED
                                    : step <= 127u ? INJECT_OBEYED
                                                   : INJECT_STALE;

        TEST_ASSERT_EQUAL(expected, send_as_it_is(&command));
        TEST_ASSERT_EQUAL_UINT16(expected == INJECT_OBEYED ? step - 1u : 0u, guard.lost_commands);
    }
}

/* The lost frame may have been a PULSE: what it would have changed must not be played. */
void test_after_a_loss_nothing_triggers_until_it_is_set_again(void)
{
    prepare();
    ++counter;

    assert_refused(INJECT_INCOMPLETE, send(trigger()));
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send_pulse(100u));
    TEST_ASSERT_EQUAL(INJECT_INCOMPLETE, send(trigger()));
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send_train(1u, 0u));
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send(trigger()));
}

void test_a_damaged_frame_changes_nothing_whatever_its_length(void)
{
    prepare();
    for (unsigned length = 0u; length <= INJECT_FRAME_BYTES; ++length) {
        inject_command_t command = trigger();
        inject_guard_t   before = guard;
        uint8_t          frame[INJECT_FRAME_BYTES];
        command.counter = (uint8_t)(counter + 1u);
        inject_frame_put_command(&command, frame);
        frame[4] ^= length == INJECT_FRAME_BYTES ? 1u : 0u;
        order = inject_guard_take(&guard, frame, (uint8_t)length, now_ms);

        TEST_ASSERT_EQUAL(INJECT_DAMAGED, order.verdict);
        TEST_ASSERT_FALSE(order.has_shot);
        ++before.verdicts[INJECT_DAMAGED];
        TEST_ASSERT_EQUAL_MEMORY(&before, &guard, sizeof guard);
    }
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send(trigger()));
}

static void assert_both_sides(inject_command_t good, inject_command_t bad)
{
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send_arm());
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send(good));
    TEST_ASSERT_EQUAL(INJECT_OUT_OF_RANGE, send(bad));
    TEST_ASSERT_FALSE(order.has_shot);
}

void test_figures_are_taken_up_to_their_limits(void)
{
    const inject_command_t pulse = {
        .kind = INJECT_PULSE, .line = LINES - 1u, .level = 1u, .width_us = INJECT_WIDTH_MAX_US};
    inject_command_t bad = pulse;
    bad.line = LINES;
    assert_both_sides(pulse, bad);
    bad = pulse;
    bad.level = 2u;
    assert_both_sides(pulse, bad);
    bad = pulse;
    bad.width_us = INJECT_WIDTH_MAX_US + 1u;
    assert_both_sides(pulse, bad);
    bad.width_us = 0u;
    assert_both_sides(pulse, bad);
    const inject_command_t train = {
        .kind = INJECT_TRAIN, .count = 1u, .period_us = INJECT_PERIOD_MAX_US};
    bad = train;
    bad.count = 0u;
    assert_both_sides(train, bad);
    bad = train;
    bad.period_us = INJECT_PERIOD_MAX_US + 1u;
    assert_both_sides(train, bad);
    const inject_command_t arm = {.kind = INJECT_ARM, .valid_ms = INJECT_VALID_MAX_MS};
    bad = arm;
    bad.valid_ms = INJECT_VALID_MAX_MS + 1u;
    assert_both_sides(arm, bad);
    bad.valid_ms = 0u;
    assert_both_sides(arm, bad);
}

void test_delay_is_taken_up_to_its_limit(void)
{
    prepare();
    inject_command_t late = trigger();
    late.delay_us = INJECT_DELAY_MAX_US + 1u;
    assert_refused(INJECT_OUT_OF_RANGE, send(late));
    late.delay_us = INJECT_DELAY_MAX_US;
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send(late));
}

void test_an_unknown_kind_is_out_of_range(void)
{
    assert_refused(INJECT_OUT_OF_RANGE, send((inject_command_t){.kind = 0u}));
    TEST_ASSERT_EQUAL(INJECT_OUT_OF_RANGE, send((inject_command_t){.kind = INJECT_ASK + 1u}));
}

void test_pulses_that_overlap_are_not_triggered(void)
{
    prepare();
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send_pulse(500u)); /* as long as the period */
    assert_refused(INJECT_OUT_OF_RANGE, send(trigger()));
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send_pulse(499u));
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send(trigger()));
}

void test_one_pulse_has_no_period(void)
{
    prepare();
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send_train(1u, 0u));
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send(trigger()));
}

void test_while_a_train_plays_no_other_begins(void)
{
    prepare();
    guard.is_running = true;
    assert_refused(INJECT_BUSY, send(trigger()));
    guard.is_running = false;
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send(trigger()));
}

void test_ask_is_answered_at_any_counter_and_changes_nothing(void)
{
    prepare();
    for (unsigned i = 0u; i < 256u; ++i) {
        inject_guard_t before = guard;
        TEST_ASSERT_EQUAL(INJECT_OBEYED,
                          send_as_it_is(&(inject_command_t){
                              .kind = INJECT_ASK, .counter = (uint8_t)i, .page = INJECT_PAGES}));

        TEST_ASSERT_EQUAL_UINT8(INJECT_PAGES, order.page);
        ++before.verdicts[INJECT_OBEYED];
        TEST_ASSERT_EQUAL_MEMORY(&before, &guard, sizeof guard);
    }
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send(trigger()));
}

void test_ask_for_a_page_that_is_not_there_is_out_of_range(void)
{
    assert_refused(INJECT_OUT_OF_RANGE,
                   send((inject_command_t){.kind = INJECT_ASK, .page = INJECT_PAGES + 1u}));
}

void test_counts_stop_at_their_maximum(void)
{
    uint8_t frame[INJECT_FRAME_BYTES] = {0u};
    guard.verdicts[INJECT_DAMAGED] = UINT16_MAX - 1u;
    (void)inject_guard_take(&guard, frame, 0u, now_ms);
    (void)inject_guard_take(&guard, frame, 0u, now_ms);

    TEST_ASSERT_EQUAL_UINT16(UINT16_MAX, guard.verdicts[INJECT_DAMAGED]);
}

void test_a_token_never_lives_again(void)
{
    prepare();
    inject_command_t late = trigger();
    now_ms += (uint64_t)UINT32_MAX + 1u;
    assert_refused(INJECT_UNARMED, send(late));
}

/* ---- wrong tokens ---- */

static inject_verdict_t send_wrong_token(void)
{
    inject_command_t wrong = trigger();
    wrong.token ^= 1u;
    return send(wrong);
}

static void send_wrong_tokens(unsigned count)
{
    for (unsigned i = 0u; i < count; ++i) {
        prepare();
        TEST_ASSERT_EQUAL(INJECT_WRONG_TOKEN, send_wrong_token());
    }
}

void test_the_third_wrong_token_drops_the_token(void)
{
    send_wrong_tokens(INJECT_WRONG_TOKENS_MAX - 1u);
    TEST_ASSERT_NOT_EQUAL(0u, guard.token);
    inject_command_t right = trigger();
    TEST_ASSERT_EQUAL(INJECT_WRONG_TOKEN, send_wrong_token());

    TEST_ASSERT_EQUAL(INJECT_IDLE, inject_guard_state(&guard, now_ms));
    assert_refused(INJECT_UNARMED, send(right));
}

void test_no_token_is_given_for_a_while_after_that(void)
{
    send_wrong_tokens(INJECT_WRONG_TOKENS_MAX);
    now_ms += INJECT_LOCKED_MS - 1u;
    TEST_ASSERT_EQUAL(INJECT_WRONG_TOKEN, send_arm());
    now_ms += 1u;
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send_arm());
    prepare();
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send(trigger()));
}

void test_wrong_tokens_are_counted_until_a_pause_without_one(void)
{
    for (unsigned i = 0u; i < INJECT_WRONG_TOKENS_MAX; ++i) {
        now_ms += INJECT_LOCKED_MS - 1u;
        TEST_ASSERT_EQUAL(INJECT_OBEYED, send_arm());
        send_wrong_tokens(1u);
    }
    TEST_ASSERT_EQUAL(INJECT_WRONG_TOKEN, send_arm());
}

void test_right_tokens_in_between_buy_no_more_wrong_ones(void)
{
    for (unsigned i = 0u; i + 1u < INJECT_WRONG_TOKENS_MAX; ++i) {
        send_wrong_tokens(1u);
        TEST_ASSERT_EQUAL(INJECT_OBEYED, send(trigger()));
    }
    send_wrong_tokens(1u);
    TEST_ASSERT_EQUAL(INJECT_WRONG_TOKEN, send_arm());
}

/* Every token in turn at 4,000 frames a second, arming whenever that helps. */
void test_a_blind_sweep_gets_three_guesses_in_ten_seconds(void)
{
    uint32_t guesses = 0u;
    uint64_t start_ms = now_ms;
    for (uint32_t frame = 0u; frame < UINT32_C(40) * 4000u; ++frame) {
        now_ms = start_ms + frame / 4u;
        (void)send_arm();
        inject_command_t guess = {.kind = INJECT_TRIGGER, .token = (uint16_t)frame};
        bool             is_armed = guard.token != 0u && guard.token != guess.token;
        guesses += send(guess) == INJECT_WRONG_TOKEN && is_armed;
    }
    TEST_ASSERT_EQUAL_UINT32(4u * INJECT_WRONG_TOKENS_MAX, guesses);
}

void test_entropy_makes_the_token(void)
{
    inject_guard_t other = guard;
    inject_guard_stir(&guard, 0x12345678u);
    inject_guard_stir(&other, 0x87654321u);
    (void)send_arm();
    inject_guard_t first = guard;
    guard = other;
    (void)(--counter, send_arm());
    TEST_ASSERT_NOT_EQUAL(first.token, guard.token);
}

void test_no_entropy_stops_the_tokens(void)
{
    inject_guard_stir(&guard, guard.random);
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send_arm());
    TEST_ASSERT_NOT_EQUAL(0u, guard.token);
}

/* ---- answers ---- */

void test_answer_tells_state_verdict_counter_and_token(void)
{
    uint8_t frame[INJECT_FRAME_BYTES];
    prepare();
    guard.is_running = true;
    inject_guard_report(&guard, 0u, INJECT_BUSY, 9u, now_ms, frame);

    const uint8_t expected[] = {0u,      INJECT_RUNNING,       INJECT_BUSY,
                                counter, (uint8_t)guard.token, (uint8_t)(guard.token >> 8),
                                9u};
    TEST_ASSERT_EQUAL_HEX8_ARRAY(expected, frame, sizeof expected);
}

void test_every_count_has_a_place_on_a_page(void)
{
    for (uint8_t i = 0u; i < INJECT_VERDICTS; ++i) {
        guard.verdicts[i] = (uint16_t)(100u + i);
    }
    guard.edges = 200u;
    guard.lost_commands = 201u;
    guard.dropped_frames = 202u;
    const uint8_t places[INJECT_PAGES][2] = {{100u, 200u}, {101u, 102u}, {103u, 104u},
                                             {105u, 106u}, {107u, 108u}, {201u, 202u}};
    for (uint8_t page = 1u; page <= INJECT_PAGES; ++page) {
        uint8_t frame[INJECT_FRAME_BYTES];
        inject_guard_report(&guard, page, INJECT_OBEYED, 0u, now_ms, frame);

        TEST_ASSERT_EQUAL_UINT8(page, frame[0]);
        TEST_ASSERT_EQUAL_UINT8(places[page - 1u][0], frame[1]);
        TEST_ASSERT_EQUAL_UINT8(places[page - 1u][1], frame[3]);
    }
}
