/* The guard with a key: only what is sealed for this session, this place and this shot plays. */
/* LINK: firmware/inject/inject_guard.c firmware/inject/inject_guard_report.c */
/* LINK: firmware/inject/inject_frame.c firmware/inject/inject_crc.c */
/* LINK: firmware/inject/inject_seal.c firmware/inject/inject_siphash.c */
#include <string.h>

#include "inject/inject_guard.h"
#include "unity.h"

#define SEED         77u
#define VALID_MS     1000u
#define SEALED_BYTES 26u

static const uint8_t KEY[INJECT_KEY_BYTES] = {0xF0u, 0xE1u, 0xD2u, 0xC3u, 0xB4u, 0xA5u,
                                              0x96u, 0x87u, 0x78u, 0x69u, 0x5Au, 0x4Bu,
                                              0x3Cu, 0x2Du, 0x1Eu, 0x0Fu};
/* What the host's TRIGGER plays: line 1, level 1, 0x0203 pulses of 0x000405 every 0x060708 µs. */
static const uint8_t SHOT[] = {1u, 1u, 3u, 2u, 5u, 4u, 0u, 8u, 7u, 6u};

static inject_guard_t guard;
static inject_order_t order;
static uint64_t       now_ms;
static uint8_t        counter; /* of the last command sent */
static uint8_t        key[INJECT_KEY_BYTES];
static uint8_t        session[INJECT_SEAL_BYTES];
static uint32_t       number; /* of the next TRIGGER in the session */

static void begin(uint32_t seed)
{
    counter = 0u;
    inject_guard_begin(&guard, seed, 2u);
    inject_guard_set_key(&guard, KEY);
}

void setUp(void)
{
    now_ms = INJECT_LOCKED_MS;
    memcpy(key, KEY, sizeof key);
    begin(SEED);
}

void tearDown(void)
{
}

/* ---- the host, written apart from the firmware ---- */

static inject_verdict_t send_as_it_is(const inject_command_t *command)
{
    uint8_t frame[INJECT_FRAME_BYTES];
    inject_frame_put_command(command, frame);
    order = inject_guard_take(&guard, frame, INJECT_FRAME_BYTES, now_ms);
    return order.verdict;
}

static inject_verdict_t send(inject_command_t command)
{
    command.counter = ++counter;
    return send_as_it_is(&command);
}

static void ask_challenge(uint8_t challenge[INJECT_SEAL_BYTES])
{
    uint8_t          status[INJECT_FRAME_BYTES];
    inject_command_t ask = {.kind = INJECT_ASK, .page = INJECT_PAGE_CHALLENGE};
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send_as_it_is(&ask));
    TEST_ASSERT_EQUAL_UINT8(INJECT_PAGE_CHALLENGE, order.page);
    inject_guard_report(&guard, order.page, order.verdict, 9u, now_ms, status);
    TEST_ASSERT_EQUAL_UINT8(INJECT_PAGE_CHALLENGE, status[0]);
    TEST_ASSERT_EQUAL_UINT8(9u, status[6]);
    memcpy(challenge, &status[1], INJECT_SEAL_BYTES);
}

/* The seal of a command that comes two after the last one sent. */
static inject_command_t seal_of(inject_command_t command, const uint8_t *challenge, uint32_t place,
                                const uint8_t *shot)
{
    inject_command_t seal = {.kind = INJECT_SEAL};
    uint8_t          sealed[SEALED_BYTES] = {0u};
    uint8_t          frame[INJECT_FRAME_BYTES];
    command.counter = (uint8_t)(counter + 2u);
    inject_frame_put_command(&command, frame);
    memcpy(sealed, challenge, INJECT_SEAL_BYTES);
    sealed[5] = (uint8_t)place;
    sealed[6] = (uint8_t)(place >> 8);
    memcpy(&sealed[9], frame, 7u);
    if (shot != NULL) {
        memcpy(&sealed[16], shot, sizeof SHOT);
    }
    uint64_t sum = inject_siphash_sum(key, sealed, SEALED_BYTES);
    for (uint8_t i = 0u; i < INJECT_SEAL_BYTES; ++i) {
        seal.seal[i] = (uint8_t)(sum >> (8u * i));
    }
    return seal;
}

static inject_verdict_t send_sealed_arm(void)
{
    inject_command_t arm = {.kind = INJECT_ARM, .valid_ms = VALID_MS};
    ask_challenge(session);
    (void)send(seal_of(arm, session, 0u, NULL));
    number = 1u;
    return send(arm);
}

static void set_shot(void)
{
    TEST_ASSERT_EQUAL(INJECT_OBEYED,
                      send((inject_command_t){
                          .kind = INJECT_PULSE, .line = 1u, .level = 1u, .width_us = 0x000405u}));
    TEST_ASSERT_EQUAL(
        INJECT_OBEYED,
        send((inject_command_t){.kind = INJECT_TRAIN, .count = 0x0203u, .period_us = 0x060708u}));
}

static void prepare(void)
{
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send_sealed_arm());
    set_shot();
}

static inject_command_t trigger(void)
{
    return (inject_command_t){.kind = INJECT_TRIGGER, .token = guard.token, .delay_us = 0x0A0B0Cu};
}

static inject_verdict_t send_sealed(inject_command_t command)
{
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send(seal_of(command, session, number, SHOT)));
    inject_verdict_t verdict = send(command);
    number += verdict == INJECT_OBEYED;
    return verdict;
}

/* A seal without meaning, then the command. */
static inject_verdict_t send_badly_sealed(inject_command_t command)
{
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send((inject_command_t){.kind = INJECT_SEAL}));
    return send(command);
}

static void assert_forged(inject_verdict_t verdict, uint16_t count)
{
    TEST_ASSERT_EQUAL(INJECT_FORGED, verdict);
    TEST_ASSERT_FALSE(order.has_shot);
    TEST_ASSERT_EQUAL_UINT16(count, guard.verdicts[INJECT_FORGED]);
}

/* ---- what is right ---- */

void test_a_sealed_session_plays_what_was_sealed(void)
{
    prepare();
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send_sealed(trigger()));

    TEST_ASSERT_TRUE(order.has_shot);
    TEST_ASSERT_EQUAL_UINT8(1u, order.shot.line);
    TEST_ASSERT_EQUAL_UINT16(0x0203u, order.shot.count);
    TEST_ASSERT_EQUAL_UINT32(0x0A0B0Cu, order.shot.delay_us);
    TEST_ASSERT_EQUAL_UINT16(0u, guard.verdicts[INJECT_FORGED]);
}

/* The counter of the frames wraps at 256, the number in the session does not. */
void test_triggers_go_on_past_the_wrap_of_the_counter(void)
{
    prepare();
    for (unsigned i = 0u; i < 300u; ++i) {
        TEST_ASSERT_EQUAL(INJECT_OBEYED, send_sealed(trigger()));
        TEST_ASSERT_TRUE(order.has_shot);
    }
    TEST_ASSERT_EQUAL_UINT32(301u, guard.seal.number);
}

void test_each_session_has_a_challenge_of_its_own(void)
{
    uint8_t before[INJECT_SEAL_BYTES];
    prepare();
    memcpy(before, session, sizeof before);
    prepare();

    TEST_ASSERT_TRUE(memcmp(before, session, sizeof before) != 0);
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send_sealed(trigger()));
}

void test_a_challenge_stays_until_it_is_spent(void)
{
    uint8_t first[INJECT_SEAL_BYTES];
    uint8_t second[INJECT_SEAL_BYTES];
    ask_challenge(first);
    inject_guard_stir(&guard, 0x12345678u);
    ask_challenge(second);

    TEST_ASSERT_EQUAL_MEMORY(first, second, sizeof first);
}

void test_asking_for_a_challenge_does_not_disturb_the_session(void)
{
    uint8_t challenge[INJECT_SEAL_BYTES];
    prepare();
    ask_challenge(challenge);

    TEST_ASSERT_EQUAL(INJECT_OBEYED, send_sealed(trigger()));
}

void test_seed_and_entropy_make_the_challenge(void)
{
    uint8_t first[INJECT_SEAL_BYTES];
    uint8_t other_seed[INJECT_SEAL_BYTES];
    uint8_t other_entropy[INJECT_SEAL_BYTES];
    ask_challenge(first);
    begin(SEED + 1u);
    ask_challenge(other_seed);
    begin(SEED);
    inject_guard_stir(&guard, 1u);
    ask_challenge(other_entropy);

    TEST_ASSERT_TRUE(memcmp(first, other_seed, sizeof first) != 0);
    TEST_ASSERT_TRUE(memcmp(first, other_entropy, sizeof first) != 0);
    TEST_ASSERT_TRUE(memcmp(other_seed, other_entropy, sizeof first) != 0);
}

/* Of start, entropy and count, four bytes each. */
void test_the_count_makes_the_challenge_as_well(void)
{
    for (uint8_t drawn = 0u; drawn < 3u; ++drawn) {
        uint8_t challenge[INJECT_SEAL_BYTES];
        uint8_t sum[INJECT_SEAL_BYTES];
        uint8_t bytes[12] = {[8] = drawn};
        for (uint8_t i = 0u; i < 4u; ++i) {
            bytes[i] = (uint8_t)(0x11223344u >> (8u * i));
            bytes[4u + i] = (uint8_t)(0x55667788u >> (8u * i));
        }
        if (drawn == 0u) {
            begin(0x11223344u);
        } else {
            TEST_ASSERT_EQUAL(INJECT_OBEYED, send_sealed_arm());
        }
        guard.random = 0x55667788u;
        ask_challenge(challenge);
        uint64_t expected = inject_siphash_sum(KEY, bytes, sizeof bytes);
        for (uint8_t i = 0u; i < INJECT_SEAL_BYTES; ++i) {
            sum[i] = (uint8_t)(expected >> (8u * i));
        }
        TEST_ASSERT_EQUAL_HEX8_ARRAY(sum, challenge, INJECT_SEAL_BYTES);
    }
}

/* Starts that are counted: whatever was drawn since, the two never give the same challenge. */
void test_the_start_shows_when_the_generators_have_met(void)
{
    uint8_t first[INJECT_SEAL_BYTES];
    uint8_t second[INJECT_SEAL_BYTES];
    begin(1u); /* 1 ^ 4 is 2 ^ 7 */
    inject_guard_stir(&guard, 4u);
    ask_challenge(first);
    begin(2u);
    inject_guard_stir(&guard, 7u);
    ask_challenge(second);

    TEST_ASSERT_EQUAL_UINT32(5u, guard.random);
    TEST_ASSERT_TRUE(memcmp(first, second, sizeof first) != 0);
}

void test_whoever_wants_to_stop_needs_no_key(void)
{
    prepare();
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send((inject_command_t){.kind = INJECT_DISARM}));

    TEST_ASSERT_TRUE(order.has_stop);
    TEST_ASSERT_EQUAL(INJECT_UNARMED, send_sealed(trigger()));
}

void test_what_is_forged_has_a_place_on_a_page(void)
{
    uint8_t          status[INJECT_FRAME_BYTES];
    inject_command_t ask = {.kind = INJECT_ASK, .page = 7u};
    guard.verdicts[INJECT_FORGED] = 0x1234u;
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send_as_it_is(&ask));
    inject_guard_report(&guard, order.page, order.verdict, 0u, now_ms, status);

    const uint8_t expected[] = {7u, 0x34u, 0x12u, 0u, 0u, 0u};
    TEST_ASSERT_EQUAL_HEX8_ARRAY(expected, status, sizeof expected);
    ask.page = INJECT_PAGES_KEYED + 1u;
    TEST_ASSERT_EQUAL(INJECT_OUT_OF_RANGE, send(ask));
}

/* ---- what is not ---- */

void test_without_a_seal_nothing_is_armed_and_no_guess_is_counted(void)
{
    for (uint16_t i = 1u; i <= 2u * INJECT_WRONG_TOKENS_MAX; ++i) {
        assert_forged(send((inject_command_t){.kind = INJECT_ARM, .valid_ms = VALID_MS}), i);
        TEST_ASSERT_EQUAL_HEX16(0u, guard.token);
    }
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send_sealed_arm());
}

void test_before_a_challenge_is_given_no_seal_fits(void)
{
    inject_command_t arm = {.kind = INJECT_ARM, .valid_ms = VALID_MS};
    uint8_t          zeros[INJECT_SEAL_BYTES] = {0u};
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send(seal_of(arm, zeros, 0u, NULL)));
    assert_forged(send(arm), 1u);
}

void test_another_key_arms_and_triggers_nothing(void)
{
    for (uint8_t bit = 0u; bit < 8u * INJECT_KEY_BYTES; bit = (uint8_t)(bit + 7u)) {
        setUp();
        key[bit / 8u] = (uint8_t)(key[bit / 8u] ^ 1u << bit % 8u);
        assert_forged(send_sealed_arm(), 1u);
        memcpy(key, KEY, sizeof key);
        prepare();
        key[bit / 8u] = (uint8_t)(key[bit / 8u] ^ 1u << bit % 8u);
        assert_forged(send_sealed(trigger()), 2u);
    }
}

void test_each_bit_of_the_seal_matters(void)
{
    for (uint8_t bit = 0u; bit < 8u * INJECT_SEAL_BYTES; ++bit) {
        setUp();
        prepare();
        inject_command_t seal = seal_of(trigger(), session, number, SHOT);
        seal.seal[bit / 8u] = (uint8_t)(seal.seal[bit / 8u] ^ 1u << bit % 8u);
        TEST_ASSERT_EQUAL(INJECT_OBEYED, send(seal));
        assert_forged(send(trigger()), 1u);
    }
}

void test_a_seal_is_of_one_delay_one_validity_and_one_counter(void)
{
    prepare();
    inject_command_t other = trigger();
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send(seal_of(other, session, number, SHOT)));
    other.delay_us ^= 1u;
    assert_forged(send(other), 1u);

    TEST_ASSERT_EQUAL(INJECT_OBEYED, send(seal_of(trigger(), session, number, SHOT)));
    TEST_ASSERT_EQUAL(INJECT_OBEYED,
                      send((inject_command_t){
                          .kind = INJECT_PULSE, .line = 1u, .level = 1u, .width_us = 0x000405u}));
    assert_forged(send(trigger()), 2u);

    inject_command_t arm = {.kind = INJECT_ARM, .valid_ms = VALID_MS};
    ask_challenge(session);
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send(seal_of(arm, session, 0u, NULL)));
    arm.valid_ms = INJECT_VALID_MAX_MS;
    assert_forged(send(arm), 3u);
}

void test_a_seal_is_of_one_shot(void)
{
    for (size_t i = 0u; i < sizeof SHOT; ++i) {
        uint8_t other[sizeof SHOT];
        setUp();
        prepare();
        memcpy(other, SHOT, sizeof other);
        other[i] ^= 1u;
        TEST_ASSERT_EQUAL(INJECT_OBEYED, send(seal_of(trigger(), session, number, other)));
        assert_forged(send(trigger()), 1u);
    }
}

void test_a_seal_serves_once(void)
{
    prepare();
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send_sealed(trigger()));
    assert_forged(send(trigger()), 1u);
    ask_challenge(session);
    assert_forged(send((inject_command_t){.kind = INJECT_ARM, .valid_ms = VALID_MS}), 2u);
    TEST_ASSERT_EQUAL_UINT8(0u, guard.wrong_tokens); /* as no seal was there, none was guessed */
}

/* At its own counter, a whole turn of counters later, with a token that has come again. */
void test_a_trigger_replayed_a_turn_later_is_forged(void)
{
    prepare();
    inject_command_t old = trigger();
    inject_command_t seal = seal_of(old, session, number, SHOT);
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send_sealed(old)); /* takes two of 256 counters */
    for (unsigned i = 0u; i < 127u; ++i) {
        set_shot();
    }
    guard.token = old.token;
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send(seal));
    assert_forged(send(old), 1u);
}

/* The second of two triggers, kept back from the first's place. */
void test_a_trigger_out_of_its_place_is_forged(void)
{
    prepare();
    inject_command_t seal = seal_of(trigger(), session, number + 1u, SHOT);
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send(seal));
    assert_forged(send(trigger()), 1u);
    seal = seal_of(trigger(), session, number + 256u, SHOT);
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send(seal));
    assert_forged(send(trigger()), 2u);
}

void test_a_seal_of_another_session_is_forged(void)
{
    uint8_t old[INJECT_SEAL_BYTES];
    prepare();
    memcpy(old, session, sizeof old);
    prepare();
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send(seal_of(trigger(), old, number, SHOT)));
    assert_forged(send(trigger()), 1u);
}

/* The whole of it, from the first frame on, after a start with another seed. */
void test_a_replayed_session_arms_nothing(void)
{
    inject_command_t session_frames[2] = {{.kind = INJECT_SEAL},
                                          {.kind = INJECT_ARM, .valid_ms = VALID_MS}};
    ask_challenge(session);
    session_frames[0] = seal_of(session_frames[1], session, 0u, NULL);
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send(session_frames[0]));
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send(session_frames[1]));

    begin(SEED + 1u);
    ask_challenge(session);
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send(session_frames[0]));
    assert_forged(send(session_frames[1]), 1u);
}

/* A SEAL that was lost is no guess, and the one before it does not stand in for it. */
void test_a_loss_drops_the_seal(void)
{
    inject_command_t arm = {.kind = INJECT_ARM, .valid_ms = VALID_MS};
    ask_challenge(session);
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send((inject_command_t){.kind = INJECT_SEAL}));
    ++counter;
    assert_forged(send(arm), 1u);
    TEST_ASSERT_EQUAL_UINT8(0u, guard.wrong_tokens);
}

void test_the_third_wrong_seal_ends_the_session_and_locks(void)
{
    prepare();
    for (uint16_t i = 1u; i <= INJECT_WRONG_TOKENS_MAX; ++i) {
        TEST_ASSERT_NOT_EQUAL(0u, guard.token);
        assert_forged(send_badly_sealed(trigger()), i);
    }
    TEST_ASSERT_EQUAL_HEX16(0u, guard.token);
    now_ms += INJECT_LOCKED_MS - 1u;
    TEST_ASSERT_EQUAL(INJECT_WRONG_TOKEN, send_sealed_arm());
    now_ms += 1u;
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send_sealed_arm());
}

void test_wrong_seals_of_arm_lock_too(void)
{
    uint8_t challenge[INJECT_SEAL_BYTES];
    ask_challenge(challenge);
    for (uint16_t i = 1u; i <= INJECT_WRONG_TOKENS_MAX; ++i) {
        assert_forged(
            send_badly_sealed((inject_command_t){.kind = INJECT_ARM, .valid_ms = VALID_MS}), i);
    }
    TEST_ASSERT_EQUAL(INJECT_WRONG_TOKEN, send_sealed_arm());
}

/* ---- without a key ---- */

void test_without_a_key_all_is_as_if_there_were_no_seals(void)
{
    inject_command_t ask = {.kind = INJECT_ASK, .page = INJECT_PAGES + 1u};
    inject_guard_begin(&guard, SEED, 2u);
    counter = 0u;
    TEST_ASSERT_EQUAL(INJECT_OUT_OF_RANGE, send((inject_command_t){.kind = INJECT_SEAL}));
    TEST_ASSERT_EQUAL(INJECT_OUT_OF_RANGE, send(ask));
    ask.page = INJECT_PAGE_CHALLENGE;
    TEST_ASSERT_EQUAL(INJECT_OUT_OF_RANGE, send(ask));
    TEST_ASSERT_EQUAL(INJECT_OBEYED,
                      send((inject_command_t){.kind = INJECT_ARM, .valid_ms = VALID_MS}));
    set_shot();
    TEST_ASSERT_EQUAL(INJECT_OBEYED, send(trigger()));
    TEST_ASSERT_TRUE(order.has_shot);
}
