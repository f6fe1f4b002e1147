#include "inject/inject_guard.h"

#include <stddef.h>
#include <string.h>

#define STEP_MAX 127u /* half the counter's range lies ahead, half behind */

/*
 * Xorshift: no secret unless it is stirred, but no two tokens in a row are alike by chance, even if
 * the first of them has expired.
 */
static uint16_t next_token(inject_guard_t *guard)
{
    uint16_t token;
    do {
        guard->random ^= guard->random << 13;
        guard->random ^= guard->random >> 17;
        guard->random ^= guard->random << 5;
        token = (uint16_t)(guard->random >> 16);
    } while (token == 0u || token == guard->last_token);
    guard->last_token = token;
    return token;
}

void inject_guard_count(uint16_t *counter, uint16_t by)
{
    *counter = (uint16_t)(UINT16_MAX - *counter > by ? *counter + by : UINT16_MAX);
}

static void forget_shot(inject_guard_t *guard)
{
    guard->has_pulse = false;
    guard->has_train = false;
}

static void expire(inject_guard_t *guard, uint64_t now_ms)
{
    if (now_ms - guard->wrong_ms >= INJECT_LOCKED_MS) {
        guard->wrong_tokens = 0u;
    }
    if (guard->token != 0u && now_ms - guard->armed_ms >= guard->valid_ms) {
        guard->token = 0u;
        forget_shot(guard);
    }
}

void inject_guard_begin(inject_guard_t *guard, uint32_t seed, uint8_t lines)
{
    *guard = (inject_guard_t){.random = seed != 0u ? seed : 1u, .lines = lines};
}

void inject_guard_stir(inject_guard_t *guard, uint32_t entropy)
{
    guard->random ^= entropy;
    if (guard->random == 0u) {
        guard->random = 1u;
    }
}

void inject_guard_set_key(inject_guard_t *guard, const uint8_t key[INJECT_KEY_BYTES])
{
    inject_seal_begin(&guard->seal, key, guard->random);
}

inject_state_t inject_guard_state(inject_guard_t *guard, uint64_t now_ms)
{
    expire(guard, now_ms);
    if (guard->is_running) {
        return INJECT_RUNNING;
    }
    return guard->token != 0u ? INJECT_ARMED : INJECT_IDLE;
}

static uint8_t last_page(const inject_guard_t *guard)
{
    return guard->seal.has_key ? INJECT_PAGES_KEYED : INJECT_PAGES;
}

static bool is_in_range(const inject_guard_t *guard, const inject_command_t *command)
{
    switch (command->kind) {
    case INJECT_ARM:
        return command->valid_ms >= 1u && command->valid_ms <= INJECT_VALID_MAX_MS;
    case INJECT_DISARM:
        return true;
    case INJECT_PULSE:
        return command->line < guard->lines && command->level <= 1u && command->width_us >= 1u &&
               command->width_us <= INJECT_WIDTH_MAX_US;
    case INJECT_TRAIN:
        return command->count >= 1u && command->period_us <= INJECT_PERIOD_MAX_US;
    case INJECT_TRIGGER:
        return command->delay_us <= INJECT_DELAY_MAX_US;
    case INJECT_ASK:
        return command->page <= last_page(guard);
    case INJECT_SEAL:
        return guard->seal.has_key;
    default:
        return false;
    }
}

/* Take the counter of a command that is in range; what is in order moves the guard on. */
static inject_verdict_t check_order(inject_guard_t *guard, uint8_t counter)
{
    uint8_t step = (uint8_t)(counter - guard->last_counter);
    if (step == 0u) {
        return INJECT_REPEATED;
    }
    if (step > STEP_MAX) {
        return INJECT_STALE;
    }
    if (step > 1u) {
        inject_guard_count(&guard->lost_commands, (uint16_t)(step - 1u));
        forget_shot(guard);
        guard->seal.has_given = false;
    }
    guard->last_counter = counter;
    return INJECT_OBEYED;
}

/* Who tries tokens or seals one after the other is stopped for a while, whoever arms. */
static inject_verdict_t refuse_guess(inject_guard_t *guard, inject_verdict_t verdict,
                                     uint64_t now_ms)
{
    guard->wrong_tokens++;
    guard->wrong_ms = now_ms;
    if (guard->wrong_tokens >= INJECT_WRONG_TOKENS_MAX) {
        guard->token = 0u;
        forget_shot(guard);
    }
    return verdict;
}

/* The last check of an ARM (`shot` is NULL) or a TRIGGER. Where no seal came, none was guessed. */
static inject_verdict_t check_seal(inject_guard_t *guard, const inject_command_t *command,
                                   const inject_shot_t *shot, uint64_t now_ms)
{
    inject_seal_t *seal = &guard->seal;
    if (!seal->has_key) {
        return INJECT_OBEYED;
    }
    if (!seal->has_given || (shot == NULL && !seal->has_challenge)) {
        return INJECT_FORGED;
    }
    return inject_seal_take(seal, command, shot) ? INJECT_OBEYED
                                                 : refuse_guess(guard, INJECT_FORGED, now_ms);
}

static inject_verdict_t arm(inject_guard_t *guard, const inject_command_t *command, uint64_t now_ms)
{
    if (guard->wrong_tokens >= INJECT_WRONG_TOKENS_MAX) {
        return INJECT_WRONG_TOKEN;
    }
    inject_verdict_t verdict = check_seal(guard, command, NULL, now_ms);
    if (verdict != INJECT_OBEYED) {
        return verdict;
    }
    guard->token = next_token(guard);
    guard->armed_ms = now_ms;
    guard->valid_ms = command->valid_ms;
    forget_shot(guard);
    return INJECT_OBEYED;
}

static inject_verdict_t disarm(inject_guard_t *guard, inject_order_t *order)
{
    guard->token = 0u;
    forget_shot(guard);
    order->has_stop = true;
    return INJECT_OBEYED;
}

static inject_verdict_t keep_seal(inject_guard_t *guard, const inject_command_t *command)
{
    memcpy(guard->seal.given, command->seal, INJECT_SEAL_BYTES);
    guard->seal.has_given = true;
    return INJECT_OBEYED;
}

static inject_verdict_t set_pulse(inject_guard_t *guard, const inject_command_t *command)
{
    guard->shot.line = command->line;
    guard->shot.level = command->level;
    guard->shot.width_us = command->width_us;
    guard->has_pulse = true;
    return INJECT_OBEYED;
}

static inject_verdict_t set_train(inject_guard_t *guard, const inject_command_t *command)
{
    guard->shot.count = command->count;
    guard->shot.period_us = command->period_us;
    guard->has_train = true;
    return INJECT_OBEYED;
}

/* A train of one pulse has no period. */
static bool overlaps(const inject_shot_t *shot)
{
    return shot->count > 1u && shot->period_us <= shot->width_us;
}

static inject_verdict_t trigger(inject_guard_t *guard, const inject_command_t *command,
                                uint64_t now_ms, inject_order_t *order)
{
    if (command->token != guard->token) {
        return refuse_guess(guard, INJECT_WRONG_TOKEN, now_ms);
    }
    if (!guard->has_pulse || !guard->has_train) {
        return INJECT_INCOMPLETE;
    }
    if (guard->is_running) {
        return INJECT_BUSY;
    }
    if (overlaps(&guard->shot)) {
        return INJECT_OUT_OF_RANGE;
    }
    inject_verdict_t verdict = check_seal(guard, command, &guard->shot, now_ms);
    if (verdict != INJECT_OBEYED) {
        return verdict;
    }
    guard->token = next_token(guard); /* so that this frame never triggers again */
    order->shot = guard->shot;
    order->shot.delay_us = command->delay_us;
    order->has_shot = true;
    return INJECT_OBEYED;
}

static inject_verdict_t obey(inject_guard_t *guard, const inject_command_t *command,
                             uint64_t now_ms, inject_order_t *order)
{
    if (command->kind == INJECT_ARM) {
        return arm(guard, command, now_ms);
    }
    if (command->kind == INJECT_DISARM) {
        return disarm(guard, order);
    }
    if (command->kind == INJECT_SEAL) {
        return keep_seal(guard, command);
    }
    if (guard->token == 0u) {
        return INJECT_UNARMED;
    }
    switch (command->kind) {
    case INJECT_PULSE:
        return set_pulse(guard, command);
    case INJECT_TRAIN:
        return set_train(guard, command);
    default:
        return trigger(guard, command, now_ms, order);
    }
}

static inject_verdict_t judge(inject_guard_t *guard, const uint8_t *frame, uint8_t length,
                              uint64_t now_ms, inject_order_t *order)
{
    inject_command_t command;
    if (length != INJECT_FRAME_BYTES || !inject_frame_get_command(frame, &command)) {
        return INJECT_DAMAGED;
    }
    if (command.kind == INJECT_ASK && is_in_range(guard, &command)) {
        order->page = command.page;
        return INJECT_OBEYED;
    }
    inject_verdict_t verdict = check_order(guard, command.counter);
    if (verdict != INJECT_OBEYED) {
        return verdict;
    }
    if (!is_in_range(guard, &command)) {
        return INJECT_OUT_OF_RANGE;
    }
    return obey(guard, &command, now_ms, order);
}

inject_order_t inject_guard_take(inject_guard_t *guard, const uint8_t *frame, uint8_t length,
                                 uint64_t now_ms)
{
    inject_order_t order = {.verdict = INJECT_DAMAGED};
    expire(guard, now_ms);
    order.verdict = judge(guard, frame, length, now_ms, &order);
    inject_guard_count(&guard->verdicts[order.verdict], 1u);
    return order;
}
