#include "train.h"

#include <stdint.h>

#include "board.h"
#include "drivers.h"
#include "hal_clock.h"
#include "wiring.h"

#define TICKS_A_SCAN (1000u / TRAIN_SPACING_US)
#define REST_TICKS   (100000u * BOARD_TICKS_PER_US) /* 100 ms */

/*
 * A rig writes how many edges shall come, and reads how many were made, and how far apart two were
 * at the least and at the most.
 */
static volatile uint32_t train_wanted;
static volatile uint32_t train_made;
static volatile uint32_t train_least_ticks = UINT32_MAX;
static volatile uint32_t train_most_ticks;

/* How often the task went round in the last 100 ms, and how many such times there were. */
static volatile uint32_t rest_rounds;
static volatile uint32_t rest_count;

static bool     is_fast;    /* the interrupt comes every TRAIN_SPACING_US */
static uint32_t edge_ticks; /* the last one */
static uint32_t ticks_to_scan;
static uint32_t rounds;
static uint32_t rounds_since_ticks;

static void note_gap(uint32_t now_ticks)
{
    uint32_t gap_ticks = now_ticks - edge_ticks;

    if (train_made != 0u && gap_ticks < train_least_ticks) {
        train_least_ticks = gap_ticks;
    }
    if (train_made != 0u && gap_ticks > train_most_ticks) {
        train_most_ticks = gap_ticks;
    }
    edge_ticks = now_ticks;
}

bool train_edge_is_due(void)
{
    if (!is_fast || train_made == train_wanted) {
        return false;
    }
    note_gap(hal_clock_now_ticks());
    ++train_made;
    return true;
}

void train_scan(void)
{
    if (ticks_to_scan == 0u) {
        ticks_to_scan = is_fast ? TICKS_A_SCAN : 1u;
        wiring_scan();
    }
    --ticks_to_scan;
}

static void start_train(void)
{
    if (train_wanted != 0u && !is_fast) {
        is_fast = true;
        scan_start(TRAIN_SPACING_US);
    }
}

static void count_rounds(void)
{
    uint32_t now = hal_clock_now_ticks();

    ++rounds;
    if ((uint32_t)(now - rounds_since_ticks) >= REST_TICKS) {
        rest_rounds = rounds;
        ++rest_count;
        rounds = 0u;
        rounds_since_ticks = now;
    }
}

int train_main(void)
{
    if (!wiring_start()) {
        return 1; /* the tables of the wiring ask for what the board does not have */
    }
    for (;;) {
        wiring_round();
        start_train();
        count_rounds();
    }
}
