/*
 * Contacts that bounce, on the simulated board with the inputs of the firmware behind it: random
 * trains of bounces never move the latch off the first edge, and a train that comes to nothing is
 * none.
 */
/* LINK: host_sim/tests/port_under_test.c tests/support/dice.c $(OUT)/libskiplatch_sim.a */
#include "../contract/port_under_test.h"
#include "dice.h"
#include "hal_clock.h"
#include "hal_edge_events.h"
#include "hal_error.h"
#include "input/plc_task.h"
#include "input/skip_input.h"
#include "input/ticks.h"
#include "unity.h"

#define TRAINS     120u
#define BEFORE_US  100u /* the line is open so long before the first edge */
#define PULSE_US   200u /* of the longest pulse and the longest gap of a train */
#define CONFIRM_US 300u
#define POLL_US    7u
#define SCAN_US    150u
/* A scan may miss any number of bounces, so the PLC waits longer than a whole train. */
#define PLC_CONFIRM_US 6000u
#define AFTER_US       6500u /* the line is watched so long after the last edge */

static skip_input_t skip;
static plc_task_t   plc;
static dice_t       dice;
static uint32_t     now_us;     /* of the train */
static uint32_t     first_scan; /* ticks of the first scan that saw the line closed */
static bool         has_scanned;
static unsigned     rises;

void hal_edge_on_latch(uint8_t channel, uint32_t captured_ticks)
{
    (void)channel;
    skip_input_on_edge(&skip, captured_ticks);
}

void setUp(void)
{
}

void tearDown(void)
{
}

static void start(uint64_t seed)
{
    const skip_input_config_t skip_config = {.edge = {.channel = 0u}};
    const plc_task_config_t   plc_config = {.period_us = SCAN_US};
    latch_config_t            config = {.repeated = false};

    dice = dice_seed(seed);
    (void)port_power_up_at(UINT32_MAX - dice_below(&dice, 8000u)); /* sometimes it wraps */
    TEST_ASSERT_EQUAL_INT(HAL_OK, skip_input_start(&skip, &skip_config));
    TEST_ASSERT_EQUAL_INT(HAL_OK, plc_task_start(&plc, &plc_config));
    config.confirm_ticks = ticks_from_us(CONFIRM_US, hal_clock_tick_ps());
    latch_arm(&skip.latch, &config);
    config.confirm_ticks = ticks_from_us(PLC_CONFIRM_US, hal_clock_tick_ps());
    latch_arm(&plc.latch, &config);
    now_us = dice_below(&dice, SCAN_US);
    has_scanned = false;
    rises = 0u;
}

static void run_scan(void)
{
    if (hal_edge_level(0u) && !has_scanned) {
        has_scanned = true;
        first_scan = hal_clock_now_ticks();
    }
    plc_task_scan(&plc);
}

/* The axis moves on by a count each µs, so that every instant has a position of its own. */
static void pass(uint32_t us)
{
    for (uint32_t i = 0u; i < us; ++i) {
        ++now_us;
        port_place_axis(0u, (int32_t)now_us);
        port_pass_us(1u);
        if (now_us % POLL_US == 0u) {
            skip_input_poll(&skip, hal_clock_now_ticks());
        }
        if (now_us % SCAN_US == 0u) {
            run_scan();
        }
    }
}

static void set_line(bool high)
{
    rises += high ? 1u : 0u;
    port_set_line(0u, high);
}

/* The line closes, opens and closes again at random; it is left as it was first closed, or open. */
static void play_train(unsigned bounces, bool stays_closed)
{
    set_line(true);
    for (unsigned i = 0u; i < bounces; ++i) {
        pass(4u + dice_below(&dice, PULSE_US));
        set_line(false);
        pass(4u + dice_below(&dice, PULSE_US));
        set_line(true);
    }
    if (!stays_closed) {
        pass(4u + dice_below(&dice, PULSE_US));
        set_line(false);
    }
    pass(AFTER_US);
}

static latch_record_t take_only_record(latch_t *latch)
{
    latch_record_t record;
    latch_record_t another;
    TEST_ASSERT_TRUE_MESSAGE(latch_take(latch, &record), "no record");
    TEST_ASSERT_FALSE_MESSAGE(latch_take(latch, &another), "two records");
    return record;
}

static void check_skip_record(uint32_t edge_ticks, uint32_t edge_us)
{
    latch_record_t record = take_only_record(&skip.latch);
    uint32_t       latency = ticks_from_us(PORT.edge_latency_us, hal_clock_tick_ps());
    TEST_ASSERT_LESS_OR_EQUAL_UINT32(latency, ticks_elapsed(record.ticks, edge_ticks));
    TEST_ASSERT_UINT32_WITHIN(PORT.edge_latency_us + 1u, edge_us, (uint32_t)record.position_counts);
    TEST_ASSERT_EQUAL_HEX8(rises > 1u ? LATCH_FLAG_BOUNCED : 0u, record.flags);
    TEST_ASSERT_EQUAL_UINT16(rises - 1u, latch_counters(&skip.latch).bounces);
}

static void check_plc_record(void)
{
    latch_record_t record = take_only_record(&plc.latch);
    TEST_ASSERT_EQUAL_UINT32(first_scan, record.ticks);
    TEST_ASSERT_EQUAL_UINT32(0u, (uint32_t)record.position_counts % SCAN_US);
    TEST_ASSERT_EQUAL_HEX8(LATCH_FLAG_PLC, record.flags & LATCH_FLAG_PLC);
}

void test_bounces_never_move_the_latch(void)
{
    for (unsigned train = 0u; train < TRAINS; ++train) {
        start(train);
        pass(BEFORE_US);
        uint32_t edge_ticks = hal_clock_now_ticks();
        uint32_t edge_us = now_us;
        play_train(train % 12u, true);

        check_skip_record(edge_ticks, edge_us);
        check_plc_record();
    }
}

void test_a_train_that_ends_open_is_no_touch(void)
{
    for (unsigned train = 0u; train < TRAINS; ++train) {
        latch_record_t record;
        start(1000u + train);
        pass(BEFORE_US);
        play_train(train % 6u, false);

        TEST_ASSERT_FALSE(latch_take(&skip.latch, &record));
        TEST_ASSERT_FALSE(latch_take(&plc.latch, &record));
        TEST_ASSERT_EQUAL_UINT16(1u, latch_counters(&skip.latch).glitches);
        TEST_ASSERT_EQUAL_UINT16(rises - 1u, latch_counters(&skip.latch).bounces);
    }
}

/* The noise of a cable, and later a touch. */
void test_a_touch_after_glitches_is_latched_at_its_own_edge(void)
{
    for (unsigned train = 0u; train < TRAINS; ++train) {
        start(2000u + train);
        pass(BEFORE_US);
        play_train(train % 4u, false);
        rises = 0u;
        has_scanned = false;
        uint16_t bounces = latch_counters(&skip.latch).bounces;
        uint32_t edge_ticks = hal_clock_now_ticks();
        set_line(true);
        pass(AFTER_US);

        latch_record_t record = take_only_record(&skip.latch);
        TEST_ASSERT_LESS_OR_EQUAL_UINT32(ticks_from_us(PORT.edge_latency_us, hal_clock_tick_ps()),
                                         ticks_elapsed(record.ticks, edge_ticks));
        TEST_ASSERT_EQUAL_HEX8(0u, record.flags);
        TEST_ASSERT_EQUAL_UINT16(bounces, latch_counters(&skip.latch).bounces);
        check_plc_record();
    }
}
