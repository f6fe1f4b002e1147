/* The injection codec: every command survives the way over the wire, and no damage gets by. */
/* LINK: firmware/inject/inject_frame.c firmware/inject/inject_crc.c */
#include <string.h>

#include "inject/inject_crc.h"
#include "inject/inject_frame.h"
#include "unity.h"

#define FRAME_BITS (8u * INJECT_FRAME_BYTES)
#define CRC        7u
#define BEFORE     0xA5u /* what stands in a frame before it is put together */

static const uint8_t DIGITS[] = {'1', '2', '3', '4', '5', '6', '7', '8', '9'};

static const inject_command_t COMMANDS[] = {
    {.kind = INJECT_ARM, .counter = 255u, .valid_ms = 60000u},
    {.kind = INJECT_DISARM, .counter = 1u},
    {.kind = INJECT_PULSE, .counter = 2u, .line = 7u, .level = 1u, .width_us = 10000000u},
    {.kind = INJECT_TRAIN, .counter = 3u, .count = 65535u, .period_us = 0x123456u},
    {.kind = INJECT_TRIGGER, .counter = 4u, .token = 0xABCDu, .delay_us = 0x654321u},
    {.kind = INJECT_ASK, .counter = 5u, .page = 6u},
    {.kind = INJECT_SEAL, .counter = 6u, .seal = {0x12u, 0x34u, 0x56u, 0x78u, 0x9Au}},
};
#define COMMAND_COUNT (sizeof COMMANDS / sizeof COMMANDS[0])

static uint8_t made[INJECT_FRAME_BYTES];
static uint8_t halves[INJECT_FRAMES_PER_EDGE][INJECT_FRAME_BYTES];

void setUp(void)
{
    memset(made, BEFORE, sizeof made);
    memset(halves, BEFORE, sizeof halves);
}

void tearDown(void)
{
}

static void assert_same(const inject_command_t *sent, const inject_command_t *got)
{
    TEST_ASSERT_EQUAL_UINT8(sent->kind, got->kind);
    TEST_ASSERT_EQUAL_UINT8(sent->counter, got->counter);
    TEST_ASSERT_EQUAL_UINT8(sent->page, got->page);
    TEST_ASSERT_EQUAL_UINT8(sent->line, got->line);
    TEST_ASSERT_EQUAL_UINT8(sent->level, got->level);
    TEST_ASSERT_EQUAL_UINT16(sent->valid_ms, got->valid_ms);
    TEST_ASSERT_EQUAL_UINT16(sent->count, got->count);
    TEST_ASSERT_EQUAL_UINT16(sent->token, got->token);
    TEST_ASSERT_EQUAL_UINT32(sent->width_us, got->width_us);
    TEST_ASSERT_EQUAL_UINT32(sent->period_us, got->period_us);
    TEST_ASSERT_EQUAL_UINT32(sent->delay_us, got->delay_us);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(sent->seal, got->seal, INJECT_SEAL_BYTES);
}

void test_the_check_value_of_the_crc_is_the_published_one(void)
{
    uint8_t crc = inject_crc_update(INJECT_CRC_START, DIGITS, sizeof DIGITS);

    TEST_ASSERT_EQUAL_HEX8(0xDFu, inject_crc_finish(crc));
}

void test_every_command_comes_out_as_it_went_in(void)
{
    for (size_t i = 0u; i < COMMAND_COUNT; ++i) {
        uint8_t          frame[INJECT_FRAME_BYTES];
        inject_command_t got;
        inject_frame_put_command(&COMMANDS[i], frame);

        TEST_ASSERT_TRUE(inject_frame_get_command(frame, &got));
        assert_same(&COMMANDS[i], &got);
    }
}

void test_bytes_of_a_trigger_stand_where_the_document_says(void)
{
    const uint8_t expected[] = {5u, 0xCDu, 0xABu, 0x21u, 0x43u, 0x65u, 4u};
    inject_frame_put_command(&COMMANDS[4], made);

    TEST_ASSERT_EQUAL_HEX8_ARRAY(expected, made, sizeof expected);
}

void test_bytes_of_a_seal_stand_where_the_document_says(void)
{
    const uint8_t expected[] = {7u, 0x12u, 0x34u, 0x56u, 0x78u, 0x9Au, 6u};
    inject_frame_put_command(&COMMANDS[6], made);

    TEST_ASSERT_EQUAL_HEX8_ARRAY(expected, made, sizeof expected);
}

void test_bytes_that_a_command_does_not_use_are_zero(void)
{
    const uint8_t expected[] = {INJECT_DISARM, 0u, 0u, 0u, 0u, 0u, 1u};
    inject_frame_put_command(&COMMANDS[1], made);

    TEST_ASSERT_EQUAL_HEX8_ARRAY(expected, made, sizeof expected);
}

/* A CRC of eight bits finds every burst of up to eight; one and two bits are tried one by one. */
void test_no_frame_with_one_or_two_wrong_bits_is_read(void)
{
    uint8_t good[INJECT_FRAME_BYTES];
    inject_frame_put_command(&COMMANDS[4], good);
    for (unsigned a = 0u; a < FRAME_BITS; ++a) {
        for (unsigned b = a; b < FRAME_BITS; ++b) {
            uint8_t          frame[INJECT_FRAME_BYTES];
            inject_command_t got;
            memcpy(frame, good, sizeof frame);
            frame[a / 8u] ^= (uint8_t)(1u << a % 8u);
            frame[b / 8u] ^= (uint8_t)(a == b ? 0u : 1u << b % 8u);

            TEST_ASSERT_FALSE(inject_frame_get_command(frame, &got));
        }
    }
}

/* The id is in the sum: a status frame under the id of commands is no command. */
void test_a_frame_of_another_id_is_not_read_as_a_command(void)
{
    const inject_answer_t answer = {.state = 1u, .token = 0x1234u};
    uint8_t               frame[INJECT_FRAME_BYTES];
    inject_command_t      got;
    for (unsigned counter = 0u; counter < 256u; ++counter) {
        inject_frame_put_answer(&answer, (uint8_t)counter, frame);

        TEST_ASSERT_FALSE(inject_frame_get_command(frame, &got));
    }
}

void test_an_answer_stands_where_the_document_says(void)
{
    const inject_answer_t answer = {.state = 2u, .verdict = 8u, .answered = 200u, .token = 0xBEEFu};
    const uint8_t         expected[] = {0u, 2u, 8u, 200u, 0xEFu, 0xBEu, 77u};
    inject_frame_put_answer(&answer, 77u, made);

    TEST_ASSERT_EQUAL_HEX8_ARRAY(expected, made, sizeof expected);
}

void test_a_page_of_counts_stands_where_the_document_says(void)
{
    const uint8_t expected[] = {3u, 0x34u, 0x12u, 0x78u, 0x56u, 0u, 9u};
    inject_frame_put_counts(3u, 0x1234u, 0x5678u, 9u, made);

    TEST_ASSERT_EQUAL_HEX8_ARRAY(expected, made, sizeof expected);
}

void test_the_time_of_an_edge_fills_two_frames(void)
{
    const inject_edge_t edge = {
        .time_ns = 0x1122334455667788u, .number = 0xABCDu, .window_bits = 63u, .level = 1u};
    const uint8_t first[] = {0xFEu, 0xCDu, 0xABu, 0x88u, 0x77u, 0x66u, 255u};
    const uint8_t second[] = {0xFFu, 0x55u, 0x44u, 0x33u, 0x22u, 0x11u, 0u};
    inject_frame_put_edge(&edge, 255u, halves);

    TEST_ASSERT_EQUAL_HEX8_ARRAY(first, halves[0], sizeof first);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(second, halves[1], sizeof second);
}

void test_an_edge_down_has_no_level(void)
{
    const inject_edge_t edge = {.level = 0u};
    inject_frame_put_edge(&edge, 7u, halves);

    TEST_ASSERT_EQUAL_HEX8(0u, halves[0][0]);
    TEST_ASSERT_EQUAL_HEX8(1u, halves[1][0]);
}

void test_the_sum_of_the_second_half_depends_on_the_first(void)
{
    const inject_edge_t one = {.time_ns = 1u, .number = 1u};
    const inject_edge_t two = {.time_ns = 1u, .number = 2u};
    uint8_t             of_one[INJECT_FRAMES_PER_EDGE][INJECT_FRAME_BYTES];
    uint8_t             of_two[INJECT_FRAMES_PER_EDGE][INJECT_FRAME_BYTES];
    inject_frame_put_edge(&one, 0u, of_one);
    inject_frame_put_edge(&two, 0u, of_two);

    TEST_ASSERT_EQUAL_HEX8_ARRAY(of_one[1], of_two[1], CRC);
    TEST_ASSERT_TRUE(of_one[1][CRC] != of_two[1][CRC]);
}

static bool is_seen(uint8_t *frame, const unsigned *bits, unsigned count)
{
    inject_command_t got;
    for (unsigned i = 0u; i < count; ++i) {
        frame[bits[i] / 8u] ^= (uint8_t)(1u << bits[i] % 8u);
    }
    bool is_read = inject_frame_get_command(frame, &got);
    for (unsigned i = 0u; i < count; ++i) {
        frame[bits[i] / 8u] ^= (uint8_t)(1u << bits[i] % 8u);
    }
    return !is_read;
}

/* All 43,744 of them. */
void test_every_error_of_one_two_or_three_bits_is_seen(void)
{
    uint8_t  frame[INJECT_FRAME_BYTES];
    unsigned bits[3];
    unsigned errors = 0u;
    inject_frame_put_command(&COMMANDS[0], frame);

    for (bits[0] = 0u; bits[0] < 64u; ++bits[0]) {
        TEST_ASSERT_TRUE(is_seen(frame, bits, 1u));
        ++errors;
        for (bits[1] = bits[0] + 1u; bits[1] < 64u; ++bits[1]) {
            TEST_ASSERT_TRUE(is_seen(frame, bits, 2u));
            ++errors;
            for (bits[2] = bits[1] + 1u; bits[2] < 64u; ++bits[2]) {
                TEST_ASSERT_TRUE(is_seen(frame, bits, 3u));
                ++errors;
            }
        }
    }
    TEST_ASSERT_EQUAL_UINT(43744u, errors);
}
