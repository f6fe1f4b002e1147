#include "play.h"

#include <math.h>
#include <string.h>

#include "unity.h"

const sim_chain_t PLAY_BENCH = {
    .skip_latency_us = 2.0,
    .tick_us = 0.001,
    .scan_us = 4000.0,
    .resolution_um = 0.001,
    .accel_mm_s2 = 3000.0,
    .report_latency_us = 500.0,
};

const sim_chain_t PLAY_MACHINE = {
    .pretravel_um = 100.0,
    .delay_us = 10.0,
    .filter_us = 5.0,
    .skip_latency_us = 2.0,
    .tick_us = 0.001,
    .scan_us = 4000.0,
    .resolution_um = 0.001,
    .accel_mm_s2 = 3000.0,
    .report_latency_us = 500.0,
    .is_machine = 1,
};

const sim_controller_t PLAY_ONE_TOUCH = {.overtravel_mm = 5.0, .reaction_us = 1000.0};

sim_touch_t play_touch(uint64_t touch, int32_t path, double time_s)
{
    return (sim_touch_t){
        .time_s = time_s,
        .feed_mm_min = 600.0,
        .approach_mm = 1.0,
        .sign = 1.0,
        .touch = touch,
        .path = path,
    };
}

void play(const sim_chain_t *chain, const sim_controller_t *controller, const sim_touch_t *touches,
          size_t n, sim_outcome_t *outcomes)
{
    const sim_rig_t rig = {.chain = chain, .controller = controller, .seed = PLAY_SEED};
    int             result = sim_play(&rig, touches, n, 1u, 1u, outcomes);
    TEST_ASSERT_EQUAL_INT_MESSAGE(SIM_PLAY_OK, result, sim_play_error(result));
}

int64_t play_ns(double us)
{
    return llrint(us * 1000.0);
}

void play_check_ok(const sim_outcome_t *outcomes, size_t n)
{
    for (size_t i = 0u; i < n; ++i) {
        TEST_ASSERT_EQUAL_INT32_MESSAGE(0, outcomes[i].error, "the cycle failed");
        TEST_ASSERT_EQUAL_INT32_MESSAGE(SIM_STATUS_OK, outcomes[i].status, "no report");
    }
}

void play_check_identical(const sim_outcome_t *expected, const sim_outcome_t *actual, size_t n)
{
    for (size_t i = 0u; i < n; ++i) {
        if (memcmp(&expected[i], &actual[i], sizeof *expected) != 0) {
            TEST_ASSERT_EQUAL_INT32_MESSAGE(expected[i].error, actual[i].error, "error");
            TEST_ASSERT_EQUAL_DOUBLE_MESSAGE(expected[i].latch_us, actual[i].latch_us, "latch");
            TEST_ASSERT_EQUAL_DOUBLE_MESSAGE(expected[i].cycle_s, actual[i].cycle_s, "cycle");
            TEST_FAIL_MESSAGE("outcomes differ");
        }
    }
}
