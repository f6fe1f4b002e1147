/* hal/ports/linux/bus.h: what becomes of frames when the kernel does not take them. */
/* LINK: hal/ports/linux/bus.c hal/ports/linux/frame_queue.c */
/* LINK: hal/ports/linux/clock.c hal/ports/linux/say.c hal/ports/linux/tests/fake_kernel.c */
#include <errno.h>
#include <fcntl.h>
#include <linux/can/error.h>
#include <string.h>
#include <unistd.h>

#include "../hal/ports/linux/bus.h"
#include "../hal/ports/linux/clock.h"
#include "../hal/ports/linux/frame_queue.h"
#include "../hal/ports/linux/tests/fake_kernel.h"
#include "hal_bus.h"
#include "hal_error.h"
#include "unity.h"

static void receive(can_received_t received)
{
    fake_kernel.to_receive_count = 1u;
    fake_kernel.received_count = 0u;
    fake_kernel.to_receive[0] = received;
    bus_receive();
}

/* What the port says of losses belongs to no test report. */
static int kept_stderr;

void setUp(void)
{
    int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
    kept_stderr = dup(STDERR_FILENO);
    (void)dup2(nowhere, STDERR_FILENO);
    (void)close(nowhere);
    fake_kernel_set_up();
    TEST_ASSERT_EQUAL_INT(0, bus_open("can0", FAKE_KERNEL_ID));
}

void tearDown(void)
{
    bus_close();
    (void)dup2(kept_stderr, STDERR_FILENO);
    (void)close(kept_stderr);
}

static int queue(uint8_t number)
{
    const uint8_t frame[HAL_BUS_FRAME_BYTES] = {number};
    return hal_bus_send(frame);
}

static void check_sent(const char *numbers)
{
    TEST_ASSERT_EQUAL_UINT(strlen(numbers), fake_kernel.sent_count);
    for (unsigned i = 0u; i < fake_kernel.sent_count; ++i) {
        TEST_ASSERT_EQUAL_UINT8(numbers[i], fake_kernel.sent[i]);
    }
}

/* ---- opening ---- */

void test_an_interface_that_is_down_is_refused(void)
{
    fake_kernel.up = 0;

    TEST_ASSERT_EQUAL_INT(ENETDOWN, bus_open("can0", FAKE_KERNEL_ID));
    TEST_ASSERT_LESS_THAN_INT(0, bus_fd());
}

void test_an_interface_there_is_not_is_refused(void)
{
    fake_kernel.open_error = ENODEV;

    TEST_ASSERT_EQUAL_INT(ENODEV, bus_open("can0", FAKE_KERNEL_ID));
}

void test_a_name_longer_than_any_interface_is_refused(void)
{
    TEST_ASSERT_EQUAL_INT(ENODEV, bus_open("sixteen_letters_", FAKE_KERNEL_ID));
    TEST_ASSERT_EQUAL_INT(0, bus_open("fifteen_letters", FAKE_KERNEL_ID));
}

/* ---- sending ---- */

void test_queued_frames_leave_in_order(void)
{
    TEST_ASSERT_EQUAL_INT(HAL_OK, queue('a'));
    TEST_ASSERT_EQUAL_INT(HAL_OK, queue('b'));
    check_sent("");

    TEST_ASSERT_TRUE(bus_flush());
    check_sent("ab");
    TEST_ASSERT_EQUAL_UINT64(2u, bus_counters().frames_sent);
}

void test_a_full_queue_refuses_and_counts(void)
{
    for (unsigned i = 0u; i < FRAME_QUEUE_LENGTH; ++i) {
        TEST_ASSERT_EQUAL_INT(HAL_OK, queue('x'));
    }

    TEST_ASSERT_EQUAL_INT(HAL_ERR_BUSY, queue('y'));
    TEST_ASSERT_EQUAL_UINT64(1u, bus_counters().queue_full);
}

void test_what_a_full_send_queue_refuses_waits_and_is_sent_once(void)
{
    (void)queue('a');
    (void)queue('b');
    fake_kernel.send_error = ENOBUFS;
    TEST_ASSERT_FALSE(bus_flush());
    TEST_ASSERT_EQUAL_UINT64(2u, bus_counters().frames_waiting);
    TEST_ASSERT_FALSE(bus_flush());
    TEST_ASSERT_EQUAL_UINT64(2u, bus_counters().send_full);
    TEST_ASSERT_FALSE(bus_is_down());

    fake_kernel.send_error = 0;
    TEST_ASSERT_TRUE(bus_flush());
    check_sent("ab");
    TEST_ASSERT_EQUAL_UINT64(0u, bus_counters().frames_waiting);
}

/* ---- losing the interface ---- */

void test_frames_wait_while_the_interface_is_down(void)
{
    (void)queue('a');
    fake_kernel.send_error = ENETDOWN;
    TEST_ASSERT_FALSE(bus_flush());
    TEST_ASSERT_TRUE(bus_is_down());
    fake_kernel.send_error = 0;
    TEST_ASSERT_FALSE(bus_flush()); /* nothing is tried before it is up again */

    bus_recover();
    TEST_ASSERT_FALSE(bus_is_down());
    TEST_ASSERT_TRUE(bus_flush());
    check_sent("a");
    TEST_ASSERT_EQUAL_UINT(1u, fake_kernel.opened);
}

void test_going_down_is_noticed_when_receiving_and_counted_once(void)
{
    fake_kernel.receive_error = ENETDOWN;
    bus_receive();
    fake_kernel.receive_error = ENETDOWN;
    bus_receive();

    TEST_ASSERT_TRUE(bus_is_down());
    TEST_ASSERT_EQUAL_UINT64(1u, bus_counters().downs);
}

void test_an_interface_still_down_is_not_taken_for_up(void)
{
    fake_kernel.receive_error = ENETDOWN;
    bus_receive();
    fake_kernel.up = 0;
    bus_recover();

    TEST_ASSERT_TRUE(bus_is_down());
}

void test_a_removed_interface_is_bound_anew_when_it_is_back(void)
{
    (void)queue('a');
    fake_kernel.send_error = ENXIO;
    TEST_ASSERT_FALSE(bus_flush());
    TEST_ASSERT_LESS_THAN_INT(0, bus_fd());
    fake_kernel.open_error = ENODEV;
    bus_recover();
    TEST_ASSERT_TRUE(bus_is_down());

    fake_kernel.open_error = 0;
    fake_kernel.send_error = 0;
    bus_recover();
    TEST_ASSERT_TRUE(bus_flush());
    check_sent("a");
    TEST_ASSERT_EQUAL_UINT(2u, fake_kernel.opened);
}

/* ---- receiving ---- */

void test_own_and_foreign_frames_are_counted_apart(void)
{
    receive((can_received_t){.frame = {.can_id = FAKE_KERNEL_ID}, .is_own = true});
    receive((can_received_t){.frame = {.can_id = FAKE_KERNEL_ID}});

    TEST_ASSERT_EQUAL_UINT64(1u, bus_counters().frames_confirmed);
    TEST_ASSERT_EQUAL_UINT64(1u, bus_counters().frames_foreign);
}

void test_the_longest_way_to_the_bus_is_kept(void)
{
    can_received_t own = {.frame = {.can_id = FAKE_KERNEL_ID, .data = {'a'}}, .is_own = true};
    (void)queue('a');
    (void)bus_flush();
    own.at_ns = clock_now_ns() + (uint64_t)CLOCK_NS_PER_S;
    receive(own);

    TEST_ASSERT_UINT64_WITHIN(500000u, 1000000u, bus_counters().slowest_us);
}

void test_a_frame_that_is_not_awaited_tells_nothing_of_the_way(void)
{
    can_received_t own = {.frame = {.can_id = FAKE_KERNEL_ID, .data = {'b'}}, .is_own = true};
    (void)queue('a');
    (void)bus_flush();
    own.at_ns = clock_now_ns() + (uint64_t)CLOCK_NS_PER_S;
    receive(own);

    TEST_ASSERT_EQUAL_UINT64(0u, bus_counters().slowest_us);
}

void test_error_frames_are_counted_by_kind(void)
{
    receive((can_received_t){.frame = {.can_id = CAN_ERR_FLAG | CAN_ERR_BUSOFF}});
    receive((can_received_t){
        .frame = {.can_id = CAN_ERR_FLAG | CAN_ERR_CRTL, .data = {0u, CAN_ERR_CRTL_TX_PASSIVE}}});
    receive((can_received_t){
        .frame = {.can_id = CAN_ERR_FLAG | CAN_ERR_CRTL, .data = {0u, CAN_ERR_CRTL_TX_WARNING}}});

    TEST_ASSERT_EQUAL_UINT64(3u, bus_counters().error_frames);
    TEST_ASSERT_EQUAL_UINT64(1u, bus_counters().bus_offs);
    TEST_ASSERT_EQUAL_UINT64(1u, bus_counters().error_passives);
    TEST_ASSERT_EQUAL_UINT64(0u, bus_counters().frames_foreign);
}

void test_missed_frames_are_the_growth_of_the_kernels_counter(void)
{
    receive((can_received_t){.has_missed = true, .missed = 3u});
    receive((can_received_t){.has_missed = true, .missed = 3u});
    receive((can_received_t){.has_missed = true, .missed = 10u});

    TEST_ASSERT_EQUAL_UINT64(10u, bus_counters().frames_missed);
}

void test_the_kernels_counter_of_missed_frames_may_wrap(void)
{
    receive((can_received_t){.has_missed = true, .missed = UINT32_MAX});
    receive((can_received_t){.has_missed = true, .missed = 4u});

    TEST_ASSERT_EQUAL_UINT64(4294967300u, bus_counters().frames_missed);
}
