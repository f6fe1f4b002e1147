/*
 * Fuzzes the guard of the injection protocol. The first byte picks one of two games: frames of
 * arbitrary bytes, or commands of an arbitrary script with a good sum, so that they get further. It
 * also says whether there is a key. Then some commands of the script are sealed, well or badly.
 */
/* LINK: firmware/inject/inject_guard.c firmware/inject/inject_guard_report.c */
/* LINK: firmware/inject/inject_frame.c firmware/inject/inject_crc.c */
/* LINK: firmware/inject/inject_seal.c firmware/inject/inject_siphash.c */
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "inject/inject_guard.h"

#define LINES        3u
#define STEP_BYTES   8u
#define LATER_MS     (1ull << 40)
#define SEALED_BYTES 26u
#define GOOD_TOKENS  4u /* one trigger in so many gets the token that is wanted */

#define CHECK(condition)                                                            \
    do {                                                                            \
        if (!(condition)) {                                                         \
            fprintf(stderr, "%s:%d: not so: %s\n", __FILE__, __LINE__, #condition); \
            abort();                                                                \
        }                                                                           \
    } while (false)

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static const uint8_t KEY[INJECT_KEY_BYTES] = {1u, 2u, 3u, 4u};

/* Numbers of a seal, low byte first. */
static void put(uint8_t *bytes, uint64_t value, uint8_t count)
{
    for (uint8_t i = 0u; i < count; ++i) {
        bytes[i] = (uint8_t)(value >> (8u * i));
    }
}

static uint32_t total(const inject_guard_t *guard)
{
    uint32_t sum = 0u;
    for (int i = 0; i < INJECT_VERDICTS; ++i) {
        sum += guard->verdicts[i];
    }
    return sum;
}

/* What is not obeyed leaves everything but counters and order as it was. */
static void check_refused(const inject_guard_t *before, const inject_guard_t *after,
                          const inject_order_t *order)
{
    CHECK(!order->has_shot && !order->has_stop);
    CHECK(after->seal.number == before->seal.number);
    CHECK(after->seal.has_challenge == before->seal.has_challenge);
    CHECK(after->token == before->token || after->token == 0u); /* it may have expired */
    CHECK(memcmp(&after->shot, &before->shot, sizeof after->shot) == 0);
    CHECK(after->has_pulse <= before->has_pulse && after->has_train <= before->has_train);
    if (order->verdict == INJECT_DAMAGED || order->verdict == INJECT_REPEATED ||
        order->verdict == INJECT_STALE) {
        CHECK(after->last_counter == before->last_counter);
        CHECK(after->lost_commands == before->lost_commands);
    }
}

/* With a key a session opens and a trigger plays under a seal alone, which is spent. */
static void check_sealed(const inject_guard_t *before, const inject_guard_t *after)
{
    CHECK(before->seal.has_given && !after->seal.has_given);
    CHECK(after->seal.number != before->seal.number || before->seal.has_challenge);
}

/* What is to be played was armed for, is in range, and spends its token. */
static void check_shot(const inject_guard_t *before, const inject_guard_t *after,
                       const inject_shot_t *shot, uint16_t token)
{
    CHECK(before->token != 0u && token == before->token && after->token != before->token);
    CHECK(before->has_pulse && before->has_train && !before->is_running);
    CHECK(shot->line < LINES && shot->level <= 1u && shot->count >= 1u);
    CHECK(shot->width_us >= 1u && shot->width_us <= INJECT_WIDTH_MAX_US);
    CHECK(shot->delay_us <= INJECT_DELAY_MAX_US);
    CHECK(shot->count == 1u || shot->period_us > shot->width_us);
}

static void take(inject_guard_t *guard, const uint8_t *frame, uint8_t length, uint64_t now_ms)
{
    inject_guard_t before = *guard;
    inject_order_t order = inject_guard_take(guard, frame, length, now_ms);
    uint8_t        status[INJECT_FRAME_BYTES];

    CHECK(order.verdict < INJECT_VERDICTS);
    CHECK(order.page <= (before.seal.has_key ? INJECT_PAGES_KEYED : INJECT_PAGES));
    CHECK(total(guard) == total(&before) + 1u || guard->verdicts[order.verdict] == UINT16_MAX);
    if (order.verdict != INJECT_OBEYED) {
        check_refused(&before, guard, &order);
    }
    if (order.has_shot) {
        check_shot(&before, guard, &order.shot, (uint16_t)(frame[1] | (unsigned)frame[2] << 8));
    }
    if (before.seal.has_key && guard->token != 0u && guard->token != before.token) {
        check_sealed(&before, guard);
    }
    inject_guard_report(guard, order.page, order.verdict, 0u, now_ms, status);
}

static void play_frames(inject_guard_t *guard, const uint8_t *data, size_t size)
{
    uint64_t now_ms = 0u;
    for (; size > INJECT_FRAME_BYTES; data += INJECT_FRAME_BYTES + 1u) {
        now_ms += data[0] / 16u;
        take(guard, &data[1], data[0] % (INJECT_FRAME_BYTES + 1u), now_ms);
        size -= INJECT_FRAME_BYTES + 1u;
    }
}

/* A command of arbitrary figures, mostly in order. */
static inject_command_t command_of(const inject_guard_t *guard, const uint8_t *step)
{
    uint32_t figure = (uint32_t)step[3] | (uint32_t)step[4] << 8 | (uint32_t)step[5] << 16;
    bool     is_told = step[7] % GOOD_TOKENS == 0u;
    return (inject_command_t){
        .kind = step[0] % 8u,
        .counter = (uint8_t)(guard->last_counter + (step[6] < 200u ? 1u : step[6])),
        .page = step[1] % 8u,
        .line = step[1] % 4u,
        .level = step[2] % 3u,
        .valid_ms = (uint16_t)figure,
        .count = (uint16_t)(step[1] | (unsigned)step[2] << 8),
        .token = is_told ? guard->token : (uint16_t)figure,
        .width_us = figure,
        .period_us = figure,
        .delay_us = figure,
        .seal = {step[1], step[2], step[3], step[4], step[5]},
    };
}

static void send(inject_guard_t *guard, const inject_command_t *command, uint64_t now_ms)
{
    uint8_t frame[INJECT_FRAME_BYTES];
    inject_frame_put_command(command, frame);
    take(guard, frame, INJECT_FRAME_BYTES, now_ms);
}

/* The seal that a copy of the guard would take for the command that comes next. */
static inject_command_t seal_of(const inject_guard_t *guard, inject_command_t command)
{
    inject_command_t seal = {.kind = INJECT_SEAL, .counter = command.counter};
    uint8_t          sealed[SEALED_BYTES] = {0u};
    uint8_t          frame[INJECT_FRAME_BYTES];
    bool             is_arm = command.kind == INJECT_ARM;
    command.counter = (uint8_t)(command.counter + 1u);
    inject_frame_put_command(&command, frame);
    memcpy(sealed, is_arm ? guard->seal.challenge : guard->seal.session, INJECT_SEAL_BYTES);
    memcpy(&sealed[9], frame, 7u);
    if (!is_arm) {
        const inject_shot_t *shot = &guard->shot;
        put(&sealed[5], guard->seal.number, 4u);
        sealed[16] = shot->line;
        sealed[17] = shot->level;
        put(&sealed[18], shot->count, 2u);
        put(&sealed[20], shot->width_us, 3u);
        put(&sealed[23], shot->period_us, 3u);
    }
    put(seal.seal, inject_siphash_sum(KEY, sealed, SEALED_BYTES), INJECT_SEAL_BYTES);
    return seal;
}

/* Well sealed where it has to be, over a challenge that was asked for. */
static void send_sealed(inject_guard_t *guard, inject_command_t command, uint64_t now_ms)
{
    if (guard->seal.has_key && (command.kind == INJECT_ARM || command.kind == INJECT_TRIGGER)) {
        inject_command_t ask = {.kind = INJECT_ASK, .page = INJECT_PAGE_CHALLENGE};
        send(guard, &ask, now_ms);
        inject_command_t seal = seal_of(guard, command);
        send(guard, &seal, now_ms);
        command.counter = (uint8_t)(command.counter + 1u);
    }
    send(guard, &command, now_ms);
}

static void play_script(inject_guard_t *guard, const uint8_t *data, size_t size)
{
    uint64_t now_ms = UINT32_MAX - 100u;
    for (; size >= STEP_BYTES; data += STEP_BYTES, size -= STEP_BYTES) {
        inject_command_t command = command_of(guard, data);
        if (data[7] / GOOD_TOKENS % 2u == 0u) {
            send_sealed(guard, command, now_ms);
        } else {
            send(guard, &command, now_ms);
        }
        guard->is_running = data[7] > 250u;
        now_ms += data[7] / 32u;
    }
}

/* Whatever came before: who asks for the counter and arms can trigger. */
static void check_still_works(inject_guard_t *guard)
{
    inject_command_t commands[] = {
        {.kind = INJECT_ARM, .valid_ms = 1000u},
        {.kind = INJECT_PULSE, .width_us = 5u},
        {.kind = INJECT_TRAIN, .count = 1u},
        {.kind = INJECT_TRIGGER},
    };
    guard->is_running = false;
    for (unsigned i = 0u; i < 4u; ++i) {
        uint16_t token = guard->token;
        commands[i].counter = (uint8_t)(guard->last_counter + 1u);
        commands[i].token = token;
        send_sealed(guard, commands[i], LATER_MS);
        CHECK((guard->token != token) == (i == 0u || i == 3u)); /* a new one: it was obeyed */
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    inject_guard_t guard;
    if (size == 0u) {
        return 0;
    }
    inject_guard_begin(&guard, data[0], LINES);
    if (data[0] / 2u % 2u == 1u) {
        inject_guard_set_key(&guard, KEY);
    }
    if (data[0] % 2u == 0u) {
        play_frames(&guard, &data[1], size - 1u);
    } else {
        play_script(&guard, &data[1], size - 1u);
    }
    check_still_works(&guard);
    return 0;
}
