/*
 * Plays touches on the simulated rig for as long as it is let, over a bus that loses, damages and
 * repeats frames and whole records, with restarts of the controller: `soak SECONDS SEED [TOUCHES]`
 * ends after the time, or after so many touches. Each record that the recorder puts together is one
 * that was sent, comes once and in order, and what was sent is received or counted as lost. At each
 * restart power cuts end operations of the store of kinematics. Exit status 0, or 1 with what fell.
 */
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "api/rig.h"
#include "dice.h"
#include "store_cuts.h"

#define BOTH    LATCH_FRAMES_PER_RECORD
#define ODDS    200u /* one frame in so many is lost, as many damaged, as many repeated */
#define QUIET   2u   /* records after and before a restart that nothing happens to */
#define RUN_MAX 60000.0
#define LATE_US 4100.0 /* latch after edge: a scan and the latency of the interrupt */
#define TOUCH_S 0.8
#define STORED  300u /* operations of the store at a restart */

static const sim_chain_t CHAIN = {
    .skip_latency_us = 2.0,
    .skip_jitter_us = 0.5,
    .tick_us = 0.25,
    .scan_us = 4000.0,
    .resolution_um = 0.1,
    .accel_mm_s2 = 3000.0,
    .report_latency_us = 500.0,
    .report_jitter_us = 50.0,
};
static const sim_controller_t CONTROLLER = {.overtravel_mm = 5.0, .reaction_us = 1000.0};

typedef struct {
    rig_t           rig;
    dice_t          dice;
    latch_decoder_t decoder; /* at the far end of the bad bus */
    uint64_t        touches;
    uint64_t        received;
    uint64_t        lost; /* as the decoder counts */
    uint64_t        restarts;
    uint64_t        seen_restarts;
    uint64_t        wraps; /* of the sequence */
    uint64_t        disturbed;
    uint32_t        left;      /* touches until the next restart */
    uint32_t        since;     /* touches since the last one */
    latch_record_t  sent;      /* the last */
    bool            has_taken; /* it has come out */
    store_cuts_t    store;
} soak_t;

static void fall(const soak_t *soak, const char *what)
{
    printf("soak: touch %llu: %s\n", (unsigned long long)soak->touches, what);
    exit(EXIT_FAILURE);
}

static void restart(soak_t *soak)
{
    sim_ns_t now = soak->rig.sim.now;
    rig_boot(&soak->rig, &CHAIN, &CONTROLLER, NULL, 0u, dice_bits(&soak->dice), 0u, now);
    soak->left = (uint32_t)dice_any_scale(&soak->dice, 2.0 * QUIET + 1.0, RUN_MAX);
    soak->since = 0u;
    for (uint32_t i = 0u; i < STORED; ++i) {
        const char *wrong = store_cuts_play(&soak->store);
        if (wrong != NULL) {
            fall(soak, wrong);
        }
    }
}

/* A record has come out of the bad bus: it is the last that was sent, whole, for the first time. */
static void check_record(soak_t *soak, const latch_record_t *record)
{
    const latch_record_t *sent = &soak->sent;
    if (soak->has_taken) {
        fall(soak, "a record came twice");
    }
    if (record->ticks != sent->ticks || record->position_counts != sent->position_counts ||
        record->sequence != sent->sequence || record->channel != sent->channel ||
        record->flags != sent->flags) {
        fall(soak, "a record is torn");
    }
    soak->has_taken = true;
    ++soak->received;
}

static void arrive(soak_t *soak, const uint8_t *frame)
{
    latch_record_t record;
    if (latch_frame_decode(&soak->decoder, frame, &record) == LATCH_FRAME_RECORD) {
        check_record(soak, &record);
    }
    soak->lost += soak->decoder.lost_records;
    soak->seen_restarts += soak->decoder.restarts;
    soak->decoder.lost_records = 0u; /* counters of 16 bits, which stop at their maximum */
    soak->decoder.restarts = 0u;
}

/* What happens to a frame, or to a record: nothing from 3 up. */
static uint32_t fate(soak_t *soak)
{
    bool is_quiet = soak->since < QUIET || soak->left <= QUIET;
    return is_quiet ? ODDS : dice_below(&soak->dice, ODDS);
}

static void pass_on(soak_t *soak, const uint8_t *frame)
{
    uint32_t kind = fate(soak);
    uint8_t  copy[LATCH_FRAME_BYTES];
    memcpy(copy, frame, sizeof copy);
    soak->disturbed += kind < 3u;
    if (kind == 0u) {
        return;
    }
    if (kind == 1u) {
        uint32_t bit = dice_below(&soak->dice, 8u * LATCH_FRAME_BYTES);
        copy[bit / 8u] ^= (uint8_t)(1u << bit % 8u);
    }
    arrive(soak, copy);
    if (kind == 2u) {
        arrive(soak, copy);
    }
}

/* What the rig sent at this touch, as a recorder on a good bus has it. */
static void read_sent(soak_t *soak, uint8_t frames[BOTH][LATCH_FRAME_BYTES])
{
    latch_decoder_t good = {0};
    uint16_t        before = soak->sent.sequence;
    (void)latch_frame_decode(&good, frames[0], &soak->sent);
    if (latch_frame_decode(&good, frames[1], &soak->sent) != LATCH_FRAME_RECORD) {
        fall(soak, "no whole record was sent");
    }
    if (soak->since > 0u && soak->sent.sequence != ((before + 1u) & LATCH_SEQUENCE_MASK)) {
        fall(soak, "a number of the sequence was left out");
    }
    soak->wraps += soak->since > 0u && soak->sent.sequence == 0u;
    soak->has_taken = false;
}

static void play(soak_t *soak)
{
    uint8_t       frames[BOTH][LATCH_FRAME_BYTES];
    sim_bus_t    *bus = &soak->rig.sim.bus;
    sim_outcome_t outcome;
    sim_touch_t   touch = {
        .time_s = TOUCH_S * (double)(soak->touches + 1u) + dice_between(&soak->dice, 0.0, 0.1),
        .feed_mm_min = dice_between(&soak->dice, 600.0, 3000.0),
        .approach_mm = 2.0,
        .touch = soak->touches,
        .path = dice_below(&soak->dice, 2u) ? SIM_PATH_PLC : SIM_PATH_SKIP,
    };
    if (rig_play(&soak->rig, &touch, &outcome) != 0 || outcome.status != SIM_STATUS_OK) {
        fall(soak, "the touch is missed");
    }
    if (!(outcome.latch_us >= outcome.true_edge_us - CHAIN.tick_us) ||
        outcome.latch_us > outcome.true_edge_us + LATE_US) {
        fall(soak, "the latch is not of this edge");
    }
    if (bus->taken != BOTH) {
        fall(soak, "not two frames were sent");
    }
    for (uint32_t i = 0u; i < BOTH; ++i) {
        memcpy(frames[i], bus->frames[i], LATCH_FRAME_BYTES);
    }
    read_sent(soak, frames);
    pass_on(soak, frames[0]);
    pass_on(soak, frames[1]);
    if (fate(soak) == 0u) { /* the whole record once more */
        arrive(soak, frames[0]);
        arrive(soak, frames[1]);
        ++soak->disturbed;
    }
    ++soak->touches;
    ++soak->since;
}

static void check_sums(const soak_t *soak)
{
    if (soak->received + soak->lost != soak->touches) {
        fall(soak, "a record was lost and not counted");
    }
    if (soak->seen_restarts != soak->restarts) {
        fall(soak, "a restart was not seen, or one too many");
    }
}

/* All touches until the next restart. */
static void play_run(soak_t *soak)
{
    while (soak->left > 0u) {
        play(soak);
        --soak->left;
    }
    check_sums(soak);
}

int main(int argc, char **argv)
{
    static soak_t soak;
    double        seconds = argc > 2 ? strtod(argv[1], NULL) : -1.0;
    uint64_t      seed = argc > 2 ? strtoull(argv[2], NULL, 10) : 0u;
    uint64_t      touches = argc > 3 ? strtoull(argv[3], NULL, 10) : UINT64_MAX;
    time_t        start = time(NULL);
    if (!(seconds >= 0.0)) {
        fputs("usage: soak SECONDS SEED [TOUCHES]\n", stderr);
        return 2;
    }
    soak.dice = dice_seed(seed);
    store_cuts_start(&soak.store, seed);
    restart(&soak);
    play_run(&soak);
    while (difftime(time(NULL), start) < seconds && soak.touches < touches) {
        restart(&soak);
        ++soak.restarts;
        play_run(&soak);
    }
    printf("soak: seed %llu: %llu touches, %llu restarts, %llu wraps, %llu frames disturbed; %llu "
           "records received, %llu lost and counted, none double or torn; %llu power cuts in %llu "
           "operations of the store\n",
           (unsigned long long)seed, (unsigned long long)soak.touches,
           (unsigned long long)soak.restarts, (unsigned long long)soak.wraps,
           (unsigned long long)soak.disturbed, (unsigned long long)soak.received,
           (unsigned long long)soak.lost, (unsigned long long)soak.store.cuts,
           (unsigned long long)soak.store.operations);
    return EXIT_SUCCESS;
}
