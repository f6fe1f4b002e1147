/*
 * The injector's guard, in any state, given any frame at any time: it fires only with the right
 * token, armed and in time, in order, complete and in range, and what it refuses changes nothing.
 * (Tokens drawn more than three times over until they fit are left out.)
 */
/* LINK: firmware/inject/inject_guard.c firmware/inject/inject_frame.c firmware/inject/inject_crc.c
 */
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
#include "any.h"
#include "inject/inject_guard.h"

/* Whatever the module can have made of it. */
static inject_guard_t any_guard(void)
{
    inject_guard_t guard;
    ASSUME(guard.random != 0u && guard.lines >= 1u && guard.lines <= INJECT_LINES);
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
    PROVE(IMPLIES(guard->wrong_tokens == INJECT_WRONG_TOKENS_MAX, guard->token == 0u));
    PROVE(guard->shot.line < guard->lines && guard->shot.level <= 1u);
    PROVE(IMPLIES(guard->has_pulse, guard->shot.width_us >= 1u));
    PROVE(guard->shot.width_us <= INJECT_WIDTH_MAX_US);
    PROVE(guard->shot.period_us <= INJECT_PERIOD_MAX_US);
    PROVE(IMPLIES(guard->has_train, guard->shot.count >= 1u));
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
    PROVE(after->shot.width_us == before->shot.width_us);
    PROVE(after->shot.line == before->shot.line && after->shot.count == before->shot.count);
}

int main(void)
{
    inject_guard_t guard = any_guard();
    inject_guard_t before = guard;
    uint8_t        frame[INJECT_FRAME_BYTES];
    uint64_t       now_ms = nondet_u64();
    ASSUME(now_ms >= before.armed_ms && now_ms >= before.wrong_ms);

    inject_order_t order = inject_guard_take(&guard, frame, nondet_u8(), now_ms);
    PROVE(order.verdict < INJECT_VERDICTS && order.page <= INJECT_PAGES);
    PROVE(guard.verdicts[order.verdict] >= before.verdicts[order.verdict]);
    PROVE(guard.lost_commands >= before.lost_commands);
    uint8_t step = (uint8_t)(guard.last_counter - before.last_counter);
    PROVE(step <= 127u);
    prove_possible(&guard);
    if (order.has_shot) {
        prove_shot(&before, &guard, &order.shot, frame, now_ms);
    }
    if (order.verdict != INJECT_OBEYED) {
        prove_refused(&before, &guard, &order);
    }
    PROVE(IMPLIES(before.wrong_tokens == INJECT_WRONG_TOKENS_MAX && guard.token != 0u,
                  now_ms - before.wrong_ms >= INJECT_LOCKED_MS));
    return 0;
}
