/*
 * The edge at every instant of a scan. PLC: latched by the first scan at or after the pin, or by
 * one of an older image; skip input: at the same distance, wherever in the scan the edge falls.
 */
/* LINK: tests/support/play.c $(OUT)/libskiplatch_sim.a */
#include "api/rig.h"
#include "play.h"
#include "unity.h"

#define TOUCHES_MAX 4000u
#define NS_PER_US   1000
#define GAP_S       0.5 /* a whole number of scans, and longer than a cycle */

static sim_touch_t   touches[TOUCHES_MAX];
static sim_outcome_t outcomes[TOUCHES_MAX];

void setUp(void)
{
}

void tearDown(void)
{
}

/* Touches at `begin_s`, each `step_ns` later in the scan than the one before. */
static void fill(int32_t path, double begin_s, double step_ns, unsigned n)
{
    for (unsigned i = 0u; i < n; ++i) {
        touches[i] = play_touch(i, path, begin_s + GAP_S * i + step_ns * 1e-9 * i);
    }
}

/* Pin to latch. */
static int64_t latency_ns(const sim_chain_t *chain, unsigned i)
{
    return play_ns(outcomes[i].latch_us) - play_ns(outcomes[i].true_edge_us) -
           play_ns(chain->filter_us);
}

/* Each touch is latched a step sooner after its edge, and after the last instant comes the next
 * scan. */
static void check_latencies(const sim_chain_t *chain, unsigned n, int64_t step_ns, int64_t delay_ns)
{
    int64_t  scan_ns = play_ns(chain->scan_us);
    unsigned next_scans = 0u;
    for (unsigned i = 1u; i < n; ++i) {
        int64_t step = latency_ns(chain, i) - latency_ns(chain, i - 1u);
        next_scans += step > 0 ? 1u : 0u;
        TEST_ASSERT_EQUAL_INT64(step > 0 ? scan_ns - step_ns : -step_ns, step);
    }
    TEST_ASSERT_EQUAL_UINT(1u, next_scans);
    for (unsigned i = 0u; i < n; ++i) {
        TEST_ASSERT_GREATER_OR_EQUAL_INT64(delay_ns, latency_ns(chain, i));
        TEST_ASSERT_LESS_THAN_INT64(delay_ns + scan_ns, latency_ns(chain, i));
    }
}

static void sweep_scan(const sim_chain_t *chain, const sim_controller_t *controller)
{
    unsigned n = (unsigned)chain->scan_us;
    fill(SIM_PATH_PLC, 1.0, NS_PER_US, n);
    play(chain, controller, touches, n, outcomes);
    play_check_ok(outcomes, n);

    int64_t delay_ns = controller->image_delay_scans * play_ns(chain->scan_us);
    check_latencies(chain, n, NS_PER_US, delay_ns);
}

void test_every_microsecond_of_a_4_ms_scan_is_latched_by_the_next_scan(void)
{
    sweep_scan(&PLAY_BENCH, &PLAY_ONE_TOUCH);
}

void test_every_microsecond_of_a_4_ms_scan_of_a_probing_machine_too(void)
{
    sweep_scan(&PLAY_MACHINE, &PLAY_ONE_TOUCH);
}

void test_every_microsecond_of_a_1_ms_scan_is_latched_by_the_scan_with_its_image(void)
{
    sim_chain_t      chain = PLAY_BENCH;
    sim_controller_t controller = PLAY_ONE_TOUCH;
    chain.scan_us = 1000.0;
    for (int32_t delay = 0; delay <= 7; ++delay) {
        controller.image_delay_scans = delay;
        sweep_scan(&chain, &controller);
    }
}

void test_a_scan_at_the_very_instant_of_the_pin_sees_it(void)
{
    fill(SIM_PATH_PLC, 1.0, NS_PER_US, TOUCHES_MAX);
    play(&PLAY_BENCH, &PLAY_ONE_TOUCH, touches, TOUCHES_MAX, outcomes);
    unsigned last = 0u; /* the last touch in the scan that sees the first */
    while (latency_ns(&PLAY_BENCH, last) > NS_PER_US) {
        ++last;
    }
    fill(SIM_PATH_PLC, touches[last].time_s, 1.0, 2u * NS_PER_US);
    play(&PLAY_BENCH, &PLAY_ONE_TOUCH, touches, 2u * NS_PER_US, outcomes);

    check_latencies(&PLAY_BENCH, 2u * NS_PER_US, 1, 0);
    unsigned at_once = 0u;
    for (unsigned i = 0u; i < 2u * NS_PER_US; ++i) {
        at_once += latency_ns(&PLAY_BENCH, i) == 0 ? 1u : 0u;
    }
    TEST_ASSERT_EQUAL_UINT(1u, at_once);
}

static void check_skip_latency(const sim_chain_t *chain)
{
    fill(SIM_PATH_SKIP, 1.0, NS_PER_US, TOUCHES_MAX);
    play(chain, &PLAY_ONE_TOUCH, touches, TOUCHES_MAX, outcomes);
    play_check_ok(outcomes, TOUCHES_MAX);

    for (unsigned i = 0u; i < TOUCHES_MAX; ++i) {
        TEST_ASSERT_EQUAL_INT64(play_ns(chain->skip_latency_us), latency_ns(chain, i));
    }
}

void test_the_skip_input_is_as_late_at_every_microsecond(void)
{
    check_skip_latency(&PLAY_BENCH);
    check_skip_latency(&PLAY_MACHINE);
}

void test_a_skip_input_without_latency_latches_the_edge_itself(void)
{
    sim_chain_t chain = PLAY_BENCH;
    chain.skip_latency_us = 0.0;
    check_skip_latency(&chain);
}

/* ---- one touch, one record ---- */

static rig_t rig;

static void check_one_record_each(const latch_t *latch, unsigned n)
{
    latch_counters_t counters = latch_counters(latch);
    TEST_ASSERT_EQUAL_UINT(n, rig.report.sequence);
    TEST_ASSERT_EQUAL_UINT16(n - 1u, rig.decoder.last_sequence);
    TEST_ASSERT_EQUAL_UINT16(0u, rig.decoder.lost_records);
    TEST_ASSERT_EQUAL_UINT16(0u, rig.decoder.damaged_frames);
    TEST_ASSERT_EQUAL_UINT16(0u, rig.decoder.repeated_frames);
    TEST_ASSERT_EQUAL_UINT16(0u, rig.decoder.unpaired_frames);
    TEST_ASSERT_EQUAL_UINT16(0u, counters.bounces);
    TEST_ASSERT_EQUAL_UINT16(0u, counters.glitches);
    TEST_ASSERT_EQUAL_UINT16(0u, counters.overruns);
    TEST_ASSERT_EQUAL_UINT16(0u, counters.unarmed);
}

static void play_on_rig(int32_t path)
{
    fill(path, 1.0, NS_PER_US, TOUCHES_MAX);
    rig_boot(&rig, &PLAY_BENCH, &PLAY_ONE_TOUCH, NULL, 0u, PLAY_SEED, 0u, 0);
    for (unsigned i = 0u; i < TOUCHES_MAX; ++i) {
        TEST_ASSERT_EQUAL_INT(0, rig_play(&rig, &touches[i], &outcomes[i]));
    }
    play_check_ok(outcomes, TOUCHES_MAX);
}

void test_each_touch_of_the_plc_is_one_record(void)
{
    play_on_rig(SIM_PATH_PLC);

    check_one_record_each(&rig.plc.latch, TOUCHES_MAX);
    TEST_ASSERT_EQUAL_UINT16(0u, rig.plc.overruns);
}

void test_each_touch_of_the_skip_input_is_one_record(void)
{
    play_on_rig(SIM_PATH_SKIP);

    check_one_record_each(&rig.skip.latch, TOUCHES_MAX);
}

/* Every scan there is goes by, executed or left out. */
void test_scans_left_out_are_counted(void)
{
    play_on_rig(SIM_PATH_PLC);
    uint32_t         lazy = rig.plc.scans;
    sim_controller_t every = PLAY_ONE_TOUCH;
    every.every_scan = 1;
    rig_boot(&rig, &PLAY_BENCH, &every, NULL, 0u, PLAY_SEED, 0u, 0);
    for (unsigned i = 0u; i < TOUCHES_MAX; ++i) {
        TEST_ASSERT_EQUAL_INT(0, rig_play(&rig, &touches[i], &outcomes[i]));
    }

    TEST_ASSERT_GREATER_THAN_UINT32(10u * TOUCHES_MAX, lazy);
    TEST_ASSERT_EQUAL_UINT32(rig.plc.scans, lazy);
}
