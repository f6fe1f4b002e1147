/*
 * The injector's guard, in any state, given any frame at any time: it fires only with the right
 * token, armed and in time, in order, complete and in range, and what it refuses changes nothing.
 * With a key it arms and fires only under the seal of exactly that; in place of SipHash stands a
 * sum that can be anything. (Tokens drawn more than three times over until they fit are left out.)
 */
/* LINK: firmware/inject/inject_guard.c firmware/inject/inject_frame.c firmware/inject/inject_crc.c
 */
/* LINK: firmware/inject/inject_seal.c */
/* CBMC: --unwind 11 --unwindset next_token.0:3 --no-unwinding-assertions */
/* MUTANT: firmware/inject/inject_guard.c: command->token != guard->token => false */
/* MUTANT: firmware/inject/inject_guard.c: now_ms - guard->armed_ms >= guard->valid_ms =>
 * (uint32_t)(now_ms - guard->armed_ms) >= guard->valid_ms */
/* MUTANT: firmware/inject/inject_guard.c: step > STEP_MAX => false */
/* MUTANT: firmware/inject/inject_guard.c: !guard->has_pulse || !guard->has_train =>
 * !guard->has_pulse */
/* MUTANT: firmware/inject/inject_guard.c: command->line < guard->lines => command->line <=
 * guard->lines */
/* MUTANT: firmware/inject/inject_guard.c: order->has_shot = true; => order->has_shot = true;
 * guard->token = command->token; */
/* MUTANT: firmware/inject/inject_guard.c: if (overlaps(&guard->shot)) => if (false) */
/* MUTANT: firmware/inject/inject_guard.c: guard->wrong_tokens >= INJECT_WRONG_TOKENS_MAX) { =>
 * false) { */
/* MUTANT: firmware/inject/inject_guard.c: UINT16_MAX - *counter > by => true */
/* MUTANT: firmware/inject/inject_guard.c: if (!seal->has_key) => if (true) */
/* MUTANT: firmware/inject/inject_guard.c: if (!seal->has_given || => if ( */
/* MUTANT: firmware/inject/inject_guard.c: &guard->shot, now_ms) => NULL, now_ms) */
/* MUTANT: firmware/inject/inject_seal.c: return differing == 0u => return true */
/* MUTANT: firmware/inject/inject_seal.c: i < INJECT_SEAL_BYTES; => i < 4u; */
/* MUTANT: firmware/inject/inject_seal.c: put(&sealed[NUMBER_OFFSET], seal->number, 4u); => ; */
/* MUTANT: firmware/inject/inject_seal.c: put(&bytes[4], shot->width_us, 3u); => ; */
/* MUTANT: firmware/inject/inject_seal.c: ++seal->number; => ; */
/* MUTANT: firmware/inject/inject_seal.c: seal->has_challenge = false; => ; */
/* MUTANT: firmware/inject/inject_seal.c: COMMAND_BYTES  7u => COMMAND_BYTES  6u */
#include <string.h>

#include "any.h"
#include "inject/inject_guard.h"

#define SEALED_BYTES 26u

static uint8_t  sealed[SEALED_BYTES]; /* what was summed last */
static uint64_t sum;                  /* and came out of it */
static bool     is_summed;

uint64_t inject_siphash_sum(const uint8_t *key, const uint8_t *bytes, uint8_t length)
{
    (void)key;
    PROVE(length == SEALED_BYTES);
    memcpy(sealed, bytes, SEALED_BYTES);
    is_summed = true;
    return sum;
}

/* Whatever the module can have made of it. */
static inject_guard_t any_guard(void)
{
    inject_guard_t guard;
    ASSUME(guard.random != 0u && guard.lines >= 1u && guard.lines <= INJECT_LINES);
    ASSUME(guard.token == 0u || guard.token == guard.last_token);
    ASSUME(guard.wrong_tokens <= INJECT_WRONG_TOKENS_MAX);
    ASSUME(IMPLIES(guard.wrong_tokens == INJECT_WRONG_TOKENS_MAX, guard.token == 0u));
    ASSUME(guard.shot.line < guard.lines && guard.shot.level <= 1u);
    ASSUME(IMPLIES(guard.has_pulse, guard.shot.width_us >= 1u));
    ASSUME(guard.shot.width_us <= INJECT_WIDTH_MAX_US);
    ASSUME(guard.shot.period_us <= INJECT_PERIOD_MAX_US);
    ASSUME(IMPLIES(guard.has_train, guard.shot.count >= 1u));
    return guard;
}

/* The same of what it is afterwards: so it holds for ever. */
static void prove_possible(const inject_guard_t *guard)
{
    PROVE(guard->random != 0u && guard->wrong_tokens <= INJECT_WRONG_TOKENS_MAX);
    PROVE(guard->token == 0u || guard->token == guard->last_token);
    PROVE(IMPLIES(guard->wrong_tokens == INJECT_WRONG_TOKENS_MAX, guard->token == 0u));
    PROVE(guard->shot.line < guard->lines && guard->shot.level <= 1u);
    PROVE(IMPLIES(guard->has_pulse, guard->shot.width_us >= 1u));
    PROVE(guard->shot.width_us <= INJECT_WIDTH_MAX_US);
    PROVE(guard->shot.period_us <= INJECT_PERIOD_MAX_US);
    PROVE(IMPLIES(guard->has_train, guard->shot.count >= 1u));
}

static uint32_t number_at(const uint8_t *bytes, uint8_t count)
{
    uint32_t number = 0u;
    for (uint8_t i = 0u; i < count; ++i) {
        number |= (uint32_t)bytes[i] << (8u * i);
    }
    return number;
}

/* The seal that was given before is that of this frame, under this challenge, at this place. */
static void prove_seal(const inject_seal_t *before, const uint8_t *challenge, uint32_t number,
                       const uint8_t *frame)
{
    PROVE(before->has_given && is_summed);
    for (uint8_t i = 0u; i < INJECT_SEAL_BYTES; ++i) {
        PROVE(before->given[i] == (uint8_t)(sum >> (8u * i)));
        PROVE(sealed[i] == challenge[i]);
    }
    PROVE(number_at(&sealed[5], 4u) == number);
    PROVE(sealed[9] == frame[0] && sealed[15] == frame[6]);
    PROVE(number_at(&sealed[10], 2u) == number_at(&frame[1], 2u));
}

static void prove_sealed_shot(const inject_guard_t *before, const inject_guard_t *after,
                              const inject_shot_t *shot, const uint8_t *frame)
{
    prove_seal(&before->seal, before->seal.session, before->seal.number, frame);
    PROVE(after->seal.number == before->seal.number + 1u);
    PROVE(number_at(&sealed[12], 3u) == shot->delay_us);
    PROVE(sealed[16] == shot->line && sealed[17] == shot->level);
    PROVE(number_at(&sealed[18], 2u) == shot->count);
    PROVE(number_at(&sealed[20], 3u) == shot->width_us);
    PROVE(number_at(&sealed[23], 3u) == shot->period_us);
}

static void prove_sealed_arm(const inject_seal_t *before, const inject_seal_t *after,
                             const uint8_t *frame)
{
    PROVE(before->has_challenge && !after->has_challenge && after->number == 1u);
    prove_seal(before, before->challenge, 0u, frame);
    PROVE(number_at(&sealed[16], 3u) == 0u);
}

static void prove_shot(const inject_guard_t *before, const inject_guard_t *after,
                       const inject_shot_t *shot, const uint8_t *frame, uint64_t now_ms)
{
    uint8_t  step = (uint8_t)(frame[6] - before->last_counter);
    uint16_t token = (uint16_t)(frame[1] | (unsigned)frame[2] << 8);

    PROVE(frame[0] == INJECT_TRIGGER && step == 1u);
    PROVE(before->token != 0u && token == before->token && after->token != token);
    PROVE(now_ms - before->armed_ms < before->valid_ms);
    PROVE(before->has_pulse && before->has_train && !before->is_running);
    PROVE(shot->line < before->lines && shot->level <= 1u);
    PROVE(shot->width_us >= 1u && shot->width_us <= INJECT_WIDTH_MAX_US);
    PROVE(shot->delay_us <= INJECT_DELAY_MAX_US && shot->period_us <= INJECT_PERIOD_MAX_US);
    PROVE(shot->count == 1u || (shot->count > 1u && shot->period_us > shot->width_us));
}

static void prove_refused(const inject_guard_t *before, const inject_guard_t *after,
                          const inject_order_t *order)
{
    PROVE(!order->has_shot && !order->has_stop);
    PROVE(after->token == before->token || after->token == 0u);
    PROVE(after->has_pulse <= before->has_pulse && after->has_train <= before->has_train);
    PROVE(after->seal.number == before->seal.number);
    PROVE(after->seal.has_challenge == before->seal.has_challenge);
    PROVE(after->shot.width_us == before->shot.width_us);
    PROVE(after->shot.line == before->shot.line && after->shot.count == before->shot.count);
}

int main(void)
{
    inject_guard_t guard = any_guard();
    inject_guard_t before = guard;
    uint8_t        frame[INJECT_FRAME_BYTES];
    uint64_t       now_ms = nondet_u64();
    sum = nondet_u64();
    ASSUME(now_ms >= before.armed_ms && now_ms >= before.wrong_ms);

    inject_order_t order = inject_guard_take(&guard, frame, nondet_u8(), now_ms);
    PROVE(order.verdict < INJECT_VERDICTS);
    PROVE(order.page <= (before.seal.has_key ? INJECT_PAGES_KEYED : INJECT_PAGES));
    PROVE(guard.verdicts[order.verdict] >= before.verdicts[order.verdict]);
    PROVE(guard.lost_commands >= before.lost_commands);
    uint8_t step = (uint8_t)(guard.last_counter - before.last_counter);
    PROVE(step <= 127u);
    prove_possible(&guard);
    if (order.has_shot) {
        prove_shot(&before, &guard, &order.shot, frame, now_ms);
    }
    if (order.has_shot && before.seal.has_key) {
        prove_sealed_shot(&before, &guard, &order.shot, frame);
    }
    bool has_ended = guard.token == 0u || guard.token == before.token;
    if (!has_ended && !order.has_shot && before.seal.has_key) {
        prove_sealed_arm(&before.seal, &guard.seal, frame);
    }
    if (order.verdict != INJECT_OBEYED) {
        prove_refused(&before, &guard, &order);
    }
    PROVE(IMPLIES(before.wrong_tokens == INJECT_WRONG_TOKENS_MAX && guard.token != 0u,
                  now_ms - before.wrong_ms >= INJECT_LOCKED_MS));
    return 0;
}
