/* hal/ports/linux/frame_queue.h: first in, first out, whole, and never more than fit. */
/* LINK: hal/ports/linux/frame_queue.c */
#include <string.h>

#include "../hal/ports/linux/frame_queue.h"
#include "unity.h"

static frame_queue_t queue;

void setUp(void)
{
    memset(&queue, 0, sizeof queue);
}

void tearDown(void)
{
}

static bool push(uint32_t number)
{
    uint8_t frame[HAL_BUS_FRAME_BYTES];
    for (uint32_t i = 0u; i < HAL_BUS_FRAME_BYTES; ++i) {
        frame[i] = (uint8_t)((number >> 8u * (i % 4u)) + i);
    }
    return frame_queue_push(&queue, frame);
}

static void check_first(uint32_t number)
{
    const uint8_t *first = frame_queue_first(&queue);
    TEST_ASSERT_NOT_NULL(first);
    for (uint32_t i = 0u; i < HAL_BUS_FRAME_BYTES; ++i) {
        TEST_ASSERT_EQUAL_HEX8((uint8_t)((number >> 8u * (i % 4u)) + i), first[i]);
    }
}

static void fill(void)
{
    for (uint32_t number = 0u; number < FRAME_QUEUE_LENGTH; ++number) {
        TEST_ASSERT_TRUE(push(number));
    }
}

void test_an_empty_queue_has_no_first_frame(void)
{
    TEST_ASSERT_NULL(frame_queue_first(&queue));
}

void test_frames_come_out_in_the_order_they_went_in(void)
{
    fill();
    for (uint32_t number = 0u; number < FRAME_QUEUE_LENGTH; ++number) {
        check_first(number);
        frame_queue_pop(&queue);
    }

    TEST_ASSERT_NULL(frame_queue_first(&queue));
}

void test_a_full_queue_takes_nothing_and_keeps_what_it_has(void)
{
    fill();

    TEST_ASSERT_FALSE(push(4711u));
    check_first(0u);
}

void test_the_order_holds_wherever_in_the_memory_the_queue_stands(void)
{
    for (uint32_t number = 0u; number < 3u * FRAME_QUEUE_LENGTH; ++number) {
        TEST_ASSERT_TRUE(push(2u * number));
        TEST_ASSERT_TRUE(push(2u * number + 1u));
        check_first(2u * number);
        frame_queue_pop(&queue);
        check_first(2u * number + 1u);
        frame_queue_pop(&queue);
    }
}
