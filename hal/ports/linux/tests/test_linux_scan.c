/* hal/ports/linux/scan.h: a scan a wake-up, and the periods that went by without one. */
/* LINK: hal/ports/linux/scan.c hal/ports/linux/clock.c */
#include <poll.h>
#include <time.h>

#include "../hal/ports/linux/clock.h"
#include "../hal/ports/linux/scan.h"
#include "unity.h"

#define PERIOD_US 2000u
#define WAIT_MS   5000

static scan_counters_t counters;

void setUp(void)
{
    counters = (scan_counters_t){0};
}

void tearDown(void)
{
    scan_stop();
}

static void check(uint64_t scans, uint64_t overruns)
{
    TEST_ASSERT_EQUAL_UINT64(scans, counters.scans);
    TEST_ASSERT_EQUAL_UINT64(overruns, counters.overruns);
}

static void sleep_us(uint32_t us)
{
    struct timespec time = {.tv_nsec = (long)us * 1000};
    (void)clock_nanosleep(CLOCK_MONOTONIC, 0, &time, NULL);
}

static void wait_for_expiry(void)
{
    struct pollfd watch = {.fd = scan_fd(), .events = POLLIN};
    TEST_ASSERT_EQUAL_INT(1, poll(&watch, 1u, WAIT_MS));
}

void test_one_period_is_one_scan_without_overrun(void)
{
    scan_count(&counters, 1u);

    check(1u, 0u);
}

void test_each_further_period_is_an_overrun(void)
{
    scan_count(&counters, 2u);
    check(1u, 1u);
    scan_count(&counters, 5u);

    check(2u, 5u);
}

void test_no_period_is_no_scan(void)
{
    scan_count(&counters, 0u);

    check(0u, 0u);
}

void test_more_periods_than_32_bits_count_are_counted(void)
{
    scan_count(&counters, 4294967298u);

    check(1u, 4294967297u);
}

void test_no_scan_is_due_before_its_period_is_over(void)
{
    TEST_ASSERT_EQUAL_INT(0, scan_start(1000000u));

    TEST_ASSERT_FALSE(scan_take());
}

void test_without_a_timer_no_scan_is_due(void)
{
    TEST_ASSERT_LESS_THAN_INT(0, scan_fd());
    TEST_ASSERT_FALSE(scan_take());
}

void test_a_scan_is_due_once_a_period_whatever_the_scan_does(void)
{
    TEST_ASSERT_EQUAL_INT(0, scan_start(PERIOD_US));
    uint64_t begin_ns = clock_now_ns();
    for (unsigned i = 0u; i < 10u; ++i) {
        wait_for_expiry();
        TEST_ASSERT_TRUE(scan_take());
    }
    scan_counters_t counted = scan_counters();
    uint64_t        passed_us = (clock_now_ns() - begin_ns) / CLOCK_NS_PER_US;

    TEST_ASSERT_EQUAL_UINT64(10u, counted.scans);
    TEST_ASSERT_GREATER_OR_EQUAL_UINT64((10u + counted.overruns) * PERIOD_US,
                                        passed_us + PERIOD_US);
    TEST_ASSERT_LESS_OR_EQUAL_UINT64(passed_us, (10u + counted.overruns - 1u) * PERIOD_US);
}

void test_periods_that_nobody_took_are_overruns_of_one_scan(void)
{
    TEST_ASSERT_EQUAL_INT(0, scan_start(PERIOD_US));
    sleep_us(10u * PERIOD_US);

    TEST_ASSERT_TRUE(scan_take());
    scan_counters_t counted = scan_counters();
    TEST_ASSERT_EQUAL_UINT64(1u, counted.scans);
    TEST_ASSERT_GREATER_OR_EQUAL_UINT64(8u, counted.overruns);
}

void test_starting_again_counts_from_zero(void)
{
    TEST_ASSERT_EQUAL_INT(0, scan_start(PERIOD_US));
    wait_for_expiry();
    TEST_ASSERT_TRUE(scan_take());
    TEST_ASSERT_EQUAL_INT(0, scan_start(PERIOD_US));

    TEST_ASSERT_EQUAL_UINT64(0u, scan_counters().scans);
}
