/* What comes from the pulse inputs: order, sense, gaps, rests, the wrap of the clock. */
/* LINK: firmware/transmission/pulse_intake.c firmware/transmission/point_frame.c
 *       firmware/comp/transmission*.c firmware/comp/pulse_judge.c firmware/comp/phase_meter.c */
#include <string.h>

#include "hal_clock.h"
#include "hal_error.h"
#include "hal_pulse.h"
#include "transmission/point_frame.h"
#include "transmission/pulse_intake.h"
#include "unity.h"

#define QUEUE_SIZE  4096u
#define POINTS_MAX  512u
#define LINE_TICKS  1000u
#define NEAR_WRAP   (UINT32_MAX - 20u * LINE_TICKS)
#define REST_TICKS  (UINT32_C(1) << 30)
#define LINE_NAS    INT64_C(648000000000) /* of the input, 2000 in a turn */
#define QUARTER_NAS (LINE_NAS / 4)

/* Both shafts turn alike; the output lies a quarter of a line behind. */
static const transmission_config_t CHAIN = {
    .method = TRANSMISSION_SUBDIVIDED,
    .lines1 = 2000u,
    .lines2 = 1000u,
    .ratio_over = 1u,
    .ratio_under = 1u,
    .meter_ticks = 1u,
};

static hal_pulse_t          queue[QUEUE_SIZE];
static unsigned             queued;
static unsigned             taken;
static uint32_t             now_ticks;
static pulse_intake_t       intake;
static transmission_point_t points[POINTS_MAX];
static unsigned             count;
static hal_pulse_edge_t     started_edge;
static unsigned             starts;
static int                  start_error;

uint32_t hal_clock_now_ticks(void)
{
    return now_ticks;
}

bool hal_pulse_take(hal_pulse_t *pulse)
{
    if (taken == queued) {
        return false;
    }
    *pulse = queue[taken];
    ++taken;
    return true;
}

int hal_pulse_start(hal_pulse_edge_t edge)
{
    started_edge = edge;
    ++starts;
    return start_error;
}

static void start_at(uint32_t ticks)
{
    queued = taken = count = 0u;
    now_ticks = ticks;
    starts = 0u;
    start_error = HAL_OK;
    TEST_ASSERT_EQUAL_INT(TRANSMISSION_OK, pulse_intake_init(&intake, &CHAIN));
}

void setUp(void)
{
    start_at(0u);
}

void tearDown(void)
{
}

static void give(uint8_t channel, uint32_t ticks)
{
    queue[queued] = (hal_pulse_t){.captured_ticks = ticks, .channel = channel};
    ++queued;
}

/* The pulses of so many lines of the input from `first` on, an output line to two of them. */
static void give_lines(int first, int lines, uint32_t begin_ticks)
{
    for (int i = first; i < first + lines; ++i) {
        uint32_t at = begin_ticks + (uint32_t)i * LINE_TICKS;
        give(0u, at);
        if (i % 2 == 0) {
            give(1u, at + LINE_TICKS / 4u);
        }
    }
}

static void poll_all(void)
{
    for (unsigned idle = 0u; idle < 2u;) {
        idle += taken == queued;
        uint8_t found = pulse_intake_poll(&intake);
        for (uint8_t i = 0u; i < found; ++i) {
            points[count] = transmission_point(&intake.core, i);
            ++count;
        }
    }
}

static void check_all_zero(unsigned expected_points)
{
    TEST_ASSERT_EQUAL_UINT(expected_points, count);
    for (unsigned i = 1u; i < count; ++i) {
        TEST_ASSERT_INT64_WITHIN(1000, points[0].delta_nas, points[i].delta_nas);
    }
}

static void check_nothing_found(void)
{
    pulse_counters_t input = transmission_counters(&intake.core, TRANSMISSION_INPUT);
    pulse_counters_t output = transmission_counters(&intake.core, TRANSMISSION_OUTPUT);
    TEST_ASSERT_EQUAL_UINT32(0u, input.missing + output.missing);
    TEST_ASSERT_EQUAL_UINT32(0u, input.extra + output.extra);
    TEST_ASSERT_EQUAL_UINT32(0u, input.slips + output.slips);
}

void test_a_set_up_that_makes_no_sense_is_refused(void)
{
    transmission_config_t config = CHAIN;
    config.ratio_under = 0u;

    TEST_ASSERT_EQUAL_INT(TRANSMISSION_ERR_RATIO, pulse_intake_init(&intake, &config));
}

void test_pulses_become_points(void)
{
    give_lines(0, 200, 5000u);
    poll_all();

    check_all_zero(99u);
    check_nothing_found();
}

void test_the_clock_may_go_round(void)
{
    start_at(NEAR_WRAP);
    give_lines(0, 200, NEAR_WRAP);
    poll_all();

    check_all_zero(99u);
    check_nothing_found();
}

/* A pulse of the one train that was seen to before an earlier one of the other. */
void test_pulses_of_two_channels_may_have_changed_places(void)
{
    for (uint32_t i = 0u; i < 200u; ++i) {
        uint32_t at = 5000u + i * LINE_TICKS;
        bool     is_swapped = i % 4u == 2u;
        if (i % 2u == 0u && is_swapped) {
            give(0u, at);
            give(1u, at - 3u);
        } else if (i % 2u == 0u) {
            give(1u, at - 3u);
            give(0u, at);
        } else {
            give(0u, at);
        }
    }
    poll_all();

    TEST_ASSERT_GREATER_THAN_UINT(95u, count);
    check_all_zero(count);
    check_nothing_found();
}

/* ---- gaps ---- */

void test_across_a_gap_nothing_is_counted(void)
{
    give_lines(0, 100, 5000u);
    unsigned gap = queued;
    give_lines(101, 100, 5000u); /* it begins with a line of the input */
    queue[gap].lost = 3u;
    poll_all();

    TEST_ASSERT_EQUAL_UINT32(3u, intake.lost);
    TEST_ASSERT_EQUAL_UINT32(1u, intake.parts);
    TEST_ASSERT_GREATER_THAN_UINT(90u, count);
    check_nothing_found();
    for (unsigned i = 1u; i < count; ++i) { /* the new part counts from its own first pulse on */
        int64_t zero_nas =
            points[i].line < points[i - 1u].line ? points[i].delta_nas : points[i - 1u].delta_nas;
        TEST_ASSERT_INT64_WITHIN(1000, zero_nas, points[i].delta_nas);
    }
    TEST_ASSERT_INT64_WITHIN(1000, points[0].delta_nas - LINE_NAS, points[count - 1u].delta_nas);
}

void test_gaps_add_up(void)
{
    for (int part = 0; part < 5; ++part) {
        unsigned begin = queued;
        give_lines(40 * part, 40, 5000u);
        queue[begin].lost = part == 0 ? 0u : UINT8_MAX;
    }
    poll_all();

    TEST_ASSERT_EQUAL_UINT32(4u * UINT8_MAX, intake.lost);
    TEST_ASSERT_EQUAL_UINT32(4u, intake.parts);
    check_all_zero(count);
}

/* ---- rests ---- */

/* So long a rest that the clock comes round to where it was. */
void test_the_clock_may_go_round_while_the_shafts_rest(void)
{
    give_lines(0, 100, 5000u);
    poll_all();
    for (uint32_t i = 0u; i < 5u; ++i) {
        now_ticks += REST_TICKS;
        poll_all();
    }
    give_lines(100, 100, 5000u + 5u * REST_TICKS);
    poll_all();

    TEST_ASSERT_GREATER_THAN_UINT(95u, count);
    check_all_zero(count);
    check_nothing_found();
    TEST_ASSERT_EQUAL_UINT32(0u, intake.parts);
}

/* ---- sense ---- */

void test_back_and_forth_comes_to_the_same_lines(void)
{
    give_lines(0, 101, 5000u);
    poll_all();
    TEST_ASSERT_EQUAL_INT(HAL_OK, pulse_intake_turn(&intake, true));
    TEST_ASSERT_EQUAL_INT(HAL_PULSE_FALLING, started_edge);
    uint32_t turned = 5000u + 101u * LINE_TICKS;
    for (uint32_t i = 0u; i < 100u; ++i) {
        if (i % 2u == 0u) {
            give(1u, turned + i * LINE_TICKS + 3u * LINE_TICKS / 4u);
        }
        give(0u, turned + (i + 1u) * LINE_TICKS);
    }
    poll_all();

    TEST_ASSERT_LESS_THAN_INT32(5, points[count - 1u].line);
    TEST_ASSERT_INT64_WITHIN(1000, points[0].delta_nas, points[count - 1u].delta_nas);
}

void test_a_turn_that_failed_is_tried_again(void)
{
    start_error = HAL_ERR_CONFIG;
    TEST_ASSERT_EQUAL_INT(HAL_ERR_CONFIG, pulse_intake_turn(&intake, true));
    TEST_ASSERT_FALSE(intake.is_backward);
    TEST_ASSERT_EQUAL_INT(HAL_ERR_CONFIG, pulse_intake_turn(&intake, true));

    start_error = HAL_OK;
    TEST_ASSERT_EQUAL_INT(HAL_OK, pulse_intake_turn(&intake, true));
    TEST_ASSERT_TRUE(intake.is_backward);
    TEST_ASSERT_EQUAL_INT(HAL_OK, pulse_intake_turn(&intake, true));
    TEST_ASSERT_EQUAL_UINT(3u, starts);
}

void test_after_a_turn_that_failed_the_old_sense_is_watched_anew(void)
{
    start_error = HAL_ERR_CONFIG;
    (void)pulse_intake_turn(&intake, true);

    start_error = HAL_OK;
    TEST_ASSERT_EQUAL_INT(HAL_OK, pulse_intake_turn(&intake, false));
    TEST_ASSERT_EQUAL_INT(HAL_PULSE_RISING, started_edge);
    TEST_ASSERT_EQUAL_UINT(2u, starts);
}

/* ---- frames ---- */

void test_a_point_in_its_frame(void)
{
    const transmission_point_t point = {.delta_nas = -QUARTER_NAS, .line = 0x12345};
    const uint8_t              expected[] = {1u, 0x45u, 0x23u, 0x2Cu, 0x0Cu, 0x48u, 0xDAu, 0xFFu};
    uint8_t                    frame[POINT_FRAME_BYTES];

    point_frame_of_point(frame, 256u, &point);

    TEST_ASSERT_EQUAL_HEX8_ARRAY(expected, frame, POINT_FRAME_BYTES);
}

void test_the_tally_in_its_frame(void)
{
    const uint8_t expected[] = {255u, 0x02u, 0x01u, 0x05u, 0x00u, 0x07u, 0x34u, 0x12u};
    uint8_t       frame[POINT_FRAME_BYTES];
    intake.core.gate.counters = (pulse_counters_t){.missing = 2u, .extra = 4u, .slips = 3u};
    intake.core.dense.counters = (pulse_counters_t){.missing = 256u, .extra = 1u, .slips = 4u};
    intake.lost = 0x51234u;

    point_frame_of_tally(frame, &intake);

    TEST_ASSERT_EQUAL_HEX8_ARRAY(expected, frame, POINT_FRAME_BYTES);
}
