#include "inject/inject_guard.h"

#define COUNT_PAGES 7u

/* Two figures to a page; docs/INJECTION.md has the same table. */
static void report_counts(const inject_guard_t *guard, uint8_t page, uint8_t counter,
                          uint8_t *frame)
{
    const uint16_t figures[COUNT_PAGES][2] = {
        {guard->verdicts[INJECT_OBEYED], guard->edges},
        {guard->verdicts[INJECT_DAMAGED], guard->verdicts[INJECT_REPEATED]},
        {guard->verdicts[INJECT_STALE], guard->verdicts[INJECT_OUT_OF_RANGE]},
        {guard->verdicts[INJECT_UNARMED], guard->verdicts[INJECT_WRONG_TOKEN]},
        {guard->verdicts[INJECT_INCOMPLETE], guard->verdicts[INJECT_BUSY]},
        {guard->lost_commands, guard->dropped_frames},
        {guard->verdicts[INJECT_FORGED], 0u},
    };
    inject_frame_put_counts(page, figures[page - 1u][0], figures[page - 1u][1], counter, frame);
}

void inject_guard_report(inject_guard_t *guard, uint8_t page, inject_verdict_t verdict,
                         uint8_t counter, uint64_t now_ms, uint8_t frame[INJECT_FRAME_BYTES])
{
    if (page == INJECT_PAGE_CHALLENGE && guard->seal.has_key) {
        inject_seal_draw(&guard->seal, guard->random);
        inject_frame_put_challenge(guard->seal.challenge, counter, frame);
        return;
    }
    if (page >= 1u && page <= COUNT_PAGES) {
        report_counts(guard, page, counter, frame);
        return;
    }
    inject_answer_t answer = {
        .state = (uint8_t)inject_guard_state(guard, now_ms),
        .verdict = (uint8_t)verdict,
        .answered = guard->last_counter,
        .token = guard->token,
    };
    inject_frame_put_answer(&answer, counter, frame);
}
