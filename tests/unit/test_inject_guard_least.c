/* The guard at the least that it takes, and what it forgets by itself. */
/* LINK: firmware/inject/inject_guard.c firmware/inject/inject_guard_report.c */
/* LINK: firmware/inject/inject_frame.c firmware/inject/inject_crc.c */
/* LINK: firmware/inject/inject_seal.c firmware/inject/inject_siphash.c */
#include "inject/inject_guard.h"
#include "unity.h"

#define SEED 2463534242u

static inject_guard_t guard;
static uint64_t       now_ms;
static uint8_t        counter;

void setUp(void)
{
    now_ms = INJECT_LOCKED_MS;
    counter = 0u;
    inject_guard_begin(&guard, SEED, 1u);
}

void tearDown(void)
{
}

static inject_verdict_t send(inject_command_t command)
{
    uint8_t frame[INJECT_FRAME_BYTES];
    command.counter = ++counter;
    inject_frame_put_command(&command, frame);
    return inject_guard_take(&guard, frame, INJECT_FRAME_BYTES, now_ms).verdict;
}

static void arm(uint16_t valid_ms)
{
    TEST_ASSERT_EQUAL(INJECT_OBEYED,
                      send((inject_command_t){.kind = INJECT_ARM, .valid_ms = valid_ms}));
}

static void set_pulse(uint32_t width_us)
{
    TEST_ASSERT_EQUAL(INJECT_OBEYED,
                      send((inject_command_t){.kind = INJECT_PULSE, .width_us = width_us}));
}

static void set_train(uint16_t count, uint32_t period_us)
{
    TEST_ASSERT_EQUAL(
        INJECT_OBEYED,
        send((inject_command_t){.kind = INJECT_TRAIN, .count = count, .period_us = period_us}));
}

static inject_verdict_t trigger(void)
{
    return send((inject_command_t){.kind = INJECT_TRIGGER, .token = guard.token});
}

void test_a_pulse_of_1_us_is_triggered_within_1_ms(void)
{
    arm(1u);
    set_pulse(1u);
    set_train(1u, 0u);
    TEST_ASSERT_EQUAL(INJECT_OBEYED, trigger());
}

void test_two_pulses_have_to_be_apart(void)
{
    arm(1u);
    set_pulse(5u);
    set_train(2u, 5u);
    TEST_ASSERT_EQUAL(INJECT_OUT_OF_RANGE, trigger());
    set_train(2u, 6u);
    TEST_ASSERT_EQUAL(INJECT_OBEYED, trigger());
}

void test_a_token_that_expired_is_not_drawn_again(void)
{
    uint32_t drawn_from = guard.random;
    arm(10u);
    uint16_t expired = guard.token;
    now_ms += 10u;
    TEST_ASSERT_EQUAL(INJECT_IDLE, inject_guard_state(&guard, now_ms));
    guard.random = drawn_from;

    arm(10u);

    TEST_ASSERT_NOT_EQUAL(expired, guard.token);
}

void test_a_session_ends_without_a_command(void)
{
    arm(10u);
    now_ms += 9u;
    TEST_ASSERT_EQUAL(INJECT_ARMED, inject_guard_state(&guard, now_ms));
    ++now_ms;
    TEST_ASSERT_EQUAL(INJECT_IDLE, inject_guard_state(&guard, now_ms));
    TEST_ASSERT_EQUAL_HEX16(0u, guard.token);
}

void test_of_the_session_before_no_pulse_is_left(void)
{
    arm(10u);
    set_pulse(5u);
    arm(10u);
    set_train(1u, 0u);
    TEST_ASSERT_EQUAL(INJECT_INCOMPLETE, trigger());
}

/* Marsaglia, "Xorshift RNGs" (2003): what follows on his seed. */
void test_tokens_are_the_upper_halves_of_a_published_generator(void)
{
    const uint32_t published[] = {723471715u, 2497366906u, 2064144800u};
    for (unsigned i = 0u; i < sizeof published / sizeof published[0]; ++i) {
        arm(1u);
        TEST_ASSERT_EQUAL_HEX16(published[i] >> 16, guard.token);
    }
}
