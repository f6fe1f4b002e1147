/*
 * Every allocation of the simulation's library fails in turn, until what asks for it succeeds: then
 * its code says so, nothing is held, and afterwards all is as without a fault. Threads that do not
 * start cost nothing but time. The allocations of skiplatch-sim are those of test_sim_program.py.
 */
/* LINK: tests/support/play.c tests/support/failing_calls.c $(OUT)/libskiplatch_sim.a */
/* LDFLAGS: -Wl,--wrap=calloc,--wrap=free,--wrap=pthread_create */
#include <stddef.h>

#include "api/five_axis_cycle.h"
#include "api/kinematics_memory.h"
#include "diagnosis/density/law.h"
#include "diagnosis/likelihood/streams.h"
#include "failing_calls.h"
#include "play.h"
#include "unity.h"

#define BLOCK_TOUCHES 4096u  /* what one thread plays */
#define TOUCHES       24576u /* more blocks than threads */
#define THREADS       4u
#define MEMORY_BYTES  16384u
#define FIRST_FAILURE 1u

static sim_touch_t   touches[TOUCHES];
static sim_outcome_t expected[TOUCHES];
static sim_outcome_t outcomes[TOUCHES];
static uint64_t      played;

static const sim_rig_t RIG = {
    .chain = &PLAY_MACHINE, .controller = &PLAY_ONE_TOUCH, .seed = PLAY_SEED};

void setUp(void)
{
    failing_calls_reset();
    played = BLOCK_TOUCHES;
    for (uint64_t i = 0u; i < TOUCHES; ++i) {
        touches[i] = play_touch(i, SIM_PATH_SKIP, (double)i);
    }
}

void tearDown(void)
{
    failing_calls_reset();
}

static int play_them(uint32_t threads)
{
    return sim_play(&RIG, touches, played, 1u, threads, outcomes);
}

static int play_touches(void)
{
    return play_them(1u);
}

static int mount_store(void)
{
    static const uint8_t memory[MEMORY_BYTES];
    TEST_ASSERT_LESS_OR_EQUAL_UINT32(MEMORY_BYTES, sim_kinematics_memory_bytes());
    sim_kinematics_memory_t *store = sim_kinematics_memory_open(memory);
    int                      code = store == NULL ? SIM_PLAY_ERR_MEMORY : SIM_PLAY_OK;
    sim_kinematics_memory_close(store);
    return code;
}

static int switch_on_machine(void)
{
    static const sim_machine_t machine = {
        .axes = {{.direction = {1.0, 0.0, 0.0}},
                 {.direction = {0.0, 1.0, 0.0}},
                 {.direction = {0.0, 0.0, 1.0}}},
        .table = {SIM_ROTARY_B, SIM_ROTARY_C, -1},
        .head = {-1, -1, -1},
        .sphere_mm = {100.0, 0.0, 50.0},
        .sphere_radius_mm = 12.5,
        .tip_radius_mm = 3.0,
    };
    static const sim_control_t control = {.touch_feed_mm_min = 120.0, .path = SIM_PATH_SKIP};
    sim_measure_kinematics_t  *opened = NULL;

    int code = sim_measure_kinematics_open(&RIG, &machine, &machine, &control, &opened);
    TEST_ASSERT_EQUAL_INT(code == SIM_PLAY_OK, opened != NULL);
    sim_measure_kinematics_close(opened);
    return code;
}

static int find_datum(void)
{
    static const double    residuals[] = {1.0, 1.1, 0.9};
    static const sim_law_t laws[] = {{.sigma = 0.1}, {.sigma = 0.1}, {.sigma = 0.1}};
    static const double    ones[] = {1.0, 1.0, 1.0};
    static const uint32_t  groups[] = {0u, 0u, 0u};
    const sim_residuals_t  of = {
        .residuals = residuals, .laws = laws, .reach = ones, .n = 3u, .resolution = 0.01};
    const sim_datum_t datum = {.per_length = ones, .groups = groups, .group_count = 1u};
    double            found = 0.0;
    double            log_densities[3];

    if (sim_law_at_best_datum(&of, &datum, &found, log_densities) != 0) {
        return SIM_PLAY_ERR_MEMORY;
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 1.0, found);
    return SIM_PLAY_OK;
}

/* Touches by the PLC, stamped and with a position, under a delay that has not quite its form; some
 * scans are late. */
static int weigh_streams(void)
{
    static const double         ones[] = {1.0, 1.0, 1.0};
    static const double         off[] = {1.0, 1.1, 0.9};
    static const uint8_t        known[] = {1u, 1u, 1u};
    static const uint32_t       groups[] = {0u, 0u, 0u};
    static const uint64_t       rows[] = {0u, 1u, 2u};
    static const sim_law_t      chain[] = {{.sigma = 0.1}, {.sigma = 0.1}, {.sigma = 0.1}};
    static const sim_touches_t  touches_3 = {.n = 3u,
                                             .speed = ones,
                                             .datum_senses = ones,
                                             .pretravel_um = ones,
                                             .wait_us = ones,
                                             .begin_us = ones,
                                             .latch_us = ones,
                                             .deviation_um = ones,
                                             .is_plc = known,
                                             .groups = groups,
                                             .resolution = 1e-4,
                                             .tick_us = 1.0,
                                             .scan_us = 1000.0,
                                             .resolution_um = 0.1,
                                             .datum_count = 1u,
                                             .is_machine = 1u,
                                             .is_polled = 1u};
    static const sim_recorded_t recorded = {
        .residuals = off, .chain = chain, .believed = off, .known = known};
    static const sim_some_t   late = {.share = 0.5, .offset = {.all = 1.0}};
    static const sim_change_t change = {.speed_ratio = {.all = 1.0},
                                        .stamp_us = {.all = 0.5},
                                        .scan_us = 1000.0,
                                        .slack = 0.1,
                                        .extras[SIM_LATCH_PLC] = &late,
                                        .extra_counts[SIM_LATCH_PLC] = 1u,
                                        .extras[SIM_LATTICE] = &late,
                                        .extra_counts[SIM_LATTICE] = 1u};
    static const uint32_t     streams[] = {SIM_LATCH_PLC, SIM_POSITION, SIM_LATTICE};
    sim_member_t              members[3];
    double                    values[SIM_STREAM_COUNT * 3u] = {0.0};
    double                    found[SIM_FAMILY_COUNT] = {0.0};
    for (uint32_t i = 0u; i < 3u; ++i) {
        members[i] = (sim_member_t){.stream = streams[i],
                                    .recorded = &recorded,
                                    .latches[1] = &recorded,
                                    .rows = rows,
                                    .count = 3u,
                                    .change = &change,
                                    .far = 1.0};
    }
    if (sim_streams_log_likelihood(&touches_3, members, 3u, values, found) != 0) {
        return SIM_PLAY_ERR_MEMORY;
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.5, 0.5, found[SIM_BY_STAMPS]);
    TEST_ASSERT_TRUE(values[SIM_POSITION * 3u] < 0.0 || values[SIM_POSITION * 3u] > 0.0);
    TEST_ASSERT_TRUE_MESSAGE(values[SIM_LATTICE * 3u] > 0.0, "all stamps on one grid");
    return SIM_PLAY_OK;
}

/* Let the n-th allocation fail for every n until it succeeds; give how many there were to fail. */
static uint32_t fail_each_allocation(int (*operation)(void))
{
    uint32_t n = FIRST_FAILURE;
    for (;; ++n) {
        failing_calls_fail(FAILING_CALLOC, n, n);
        int code = operation();
        TEST_ASSERT_EQUAL_UINT32_MESSAGE(0u, failing_calls_held(), "memory is held");
        if (failing_calls_made(FAILING_CALLOC) < n) {
            TEST_ASSERT_EQUAL_INT(SIM_PLAY_OK, code);
            return n - FIRST_FAILURE;
        }
        TEST_ASSERT_EQUAL_INT(SIM_PLAY_ERR_MEMORY, code);
    }
}

void test_touches_are_refused_and_then_played(void)
{
    TEST_ASSERT_EQUAL_UINT32(1u, fail_each_allocation(play_touches));
    play_check_ok(outcomes, played);
}

void test_a_store_is_refused_and_then_mounted(void)
{
    TEST_ASSERT_EQUAL_UINT32(1u, fail_each_allocation(mount_store));
}

void test_a_machine_is_refused_and_then_switched_on(void)
{
    TEST_ASSERT_EQUAL_UINT32(1u, fail_each_allocation(switch_on_machine));
}

void test_a_datum_is_refused_and_then_found(void)
{
    TEST_ASSERT_EQUAL_UINT32(3u, fail_each_allocation(find_datum));
}

void test_threads_that_do_not_start_leave_their_work_to_the_others(void)
{
    played = TOUCHES;
    play(&PLAY_MACHINE, &PLAY_ONE_TOUCH, touches, played, expected);
    for (uint32_t n = FIRST_FAILURE; n <= THREADS; ++n) {
        failing_calls_fail(FAILING_THREAD, n, UINT32_MAX);
        TEST_ASSERT_EQUAL_INT(SIM_PLAY_OK, play_them(THREADS));
        play_check_identical(expected, outcomes, played);
        TEST_ASSERT_EQUAL_UINT32(n < THREADS ? n : THREADS - 1u,
                                 failing_calls_made(FAILING_THREAD));
        TEST_ASSERT_EQUAL_UINT32(0u, failing_calls_held());
    }
}

void test_touches_are_refused_and_then_weighed(void)
{
    /* Which of two streams that have each a datum; for each its room and its datum, and for the
     * position what the latch tells of its form, and the rest of a tick. Of the grid the late
     * scans, a table and its law, and room for the stamps. */
    TEST_ASSERT_EQUAL_UINT32(1u + (4u + 3u) + (4u + 2u + 2u + 3u) + (1u + 2u + 1u),
                             fail_each_allocation(weigh_streams));
}
