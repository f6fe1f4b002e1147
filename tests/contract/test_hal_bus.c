/* hal_bus.h: frames arrive whole, once and in order, or are refused. */
/* LINK: host_sim/tests/port_under_test.c tests/support/edge_log.c $(OUT)/libskiplatch_sim.a */
#include <string.h>

#include "../contract/port_under_test.h"
#include "hal_bus.h"
#include "hal_error.h"
#include "unity.h"

#define ENOUGH 10000u /* no queue is as long as that */

void setUp(void)
{
    port_power_up();
}

void tearDown(void)
{
}

/* Frame `number` differs from every other one and in every byte from its neighbours. */
static void make_frame(uint32_t number, uint8_t frame[HAL_BUS_FRAME_BYTES])
{
    for (uint32_t i = 0u; i < HAL_BUS_FRAME_BYTES; ++i) {
        frame[i] = (uint8_t)(i < 4u ? number >> 8u * i : ~(number * 31u + i));
    }
}

static int send(uint32_t number)
{
    uint8_t frame[HAL_BUS_FRAME_BYTES];
    make_frame(number, frame);
    int result = hal_bus_send(frame);
    memset(frame, 0xA5, sizeof frame); /* the bytes are the caller's again */
    return result;
}

static void check_arrives(uint32_t number)
{
    uint8_t expected[HAL_BUS_FRAME_BYTES];
    uint8_t frame[HAL_BUS_FRAME_BYTES];
    make_frame(number, expected);
    TEST_ASSERT_TRUE_MESSAGE(port_receive(frame), "a frame is missing");
    TEST_ASSERT_EQUAL_HEX8_ARRAY(expected, frame, HAL_BUS_FRAME_BYTES);
}

static void check_nothing_arrives(void)
{
    uint8_t frame[HAL_BUS_FRAME_BYTES];
    TEST_ASSERT_FALSE_MESSAGE(port_receive(frame), "a frame too many");
}

/* Fill the queue; returns how many frames it took. */
static uint32_t fill(void)
{
    uint32_t number = 0u;
    int      result = HAL_OK;
    while (number < ENOUGH && (result = send(number)) == HAL_OK) {
        ++number;
    }
    TEST_ASSERT_EQUAL_INT(HAL_ERR_BUSY, result);
    return number;
}

void test_a_frame_arrives_whole_and_once(void)
{
    TEST_ASSERT_EQUAL_INT(HAL_OK, send(1u));
    port_pass_us(PORT.frame_latency_us);

    check_arrives(1u);
    check_nothing_arrives();
}

void test_frames_arrive_in_the_order_they_were_sent(void)
{
    for (uint32_t round = 0u; round < 20u; ++round) {
        TEST_ASSERT_EQUAL_INT(HAL_OK, send(2u * round));
        TEST_ASSERT_EQUAL_INT(HAL_OK, send(2u * round + 1u));
        port_pass_us(PORT.frame_latency_us);

        check_arrives(2u * round);
        check_arrives(2u * round + 1u);
    }
    check_nothing_arrives();
}

void test_the_queue_holds_a_whole_record(void)
{
    TEST_ASSERT_GREATER_OR_EQUAL_UINT32(2u, fill());
}

void test_what_a_full_queue_took_arrives_and_what_it_refused_does_not(void)
{
    uint32_t sent = fill();
    for (uint32_t i = 0u; i < sent; ++i) {
        port_pass_us(PORT.frame_latency_us);
    }

    for (uint32_t number = 0u; number < sent; ++number) {
        check_arrives(number);
    }
    check_nothing_arrives();
}

void test_a_queue_that_has_emptied_takes_frames_again(void)
{
    uint32_t sent = fill();
    for (uint32_t i = 0u; i < sent; ++i) {
        port_pass_us(PORT.frame_latency_us);
        check_arrives(i);
    }

    TEST_ASSERT_EQUAL_INT(HAL_OK, send(99u));
    port_pass_us(PORT.frame_latency_us);
    check_arrives(99u);
}

/* Sent one shortly after the other, so that a shorter way could overtake a longer one. */
void test_frames_do_not_overtake(void)
{
    for (uint32_t round = 0u; round < 200u; ++round) {
        TEST_ASSERT_EQUAL_INT(HAL_OK, send(2u * round));
        port_pass_us(1u);
        TEST_ASSERT_EQUAL_INT(HAL_OK, send(2u * round + 1u));
        port_pass_us(2u * PORT.frame_latency_us);

        check_arrives(2u * round);
        check_arrives(2u * round + 1u);
    }
}
