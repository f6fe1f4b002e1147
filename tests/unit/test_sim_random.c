/* The simulation's random numbers: Philox 4x32-10 as published, and a stream for each of
 * everything. */
/* LINK: host_sim/random.c tests/support/statistics.c */
#include <math.h>

#include "random.h"
#include "statistics.h"
#include "unity.h"

#define TWO_POW_32 4294967296.0
#define N          100000u

static sim_random_t stream;
static double       values[N];

void setUp(void)
{
}

void tearDown(void)
{
}

static uint32_t draw_word(void)
{
    return (uint32_t)sim_random_uniform(&stream, TWO_POW_32);
}

static uint32_t first_word(uint64_t seed, uint64_t replicate, uint64_t touch, uint32_t lane)
{
    sim_random_begin(&stream, seed, replicate, touch, lane);
    return draw_word();
}

/* The first of the known answers that come with Random123. */
void test_the_words_are_those_of_philox(void)
{
    static const uint32_t expected[] = {0x6627E8D5u, 0xE169C58Du, 0xBC57AC4Cu, 0x9B00DBD8u};
    sim_random_begin(&stream, 0u, 0u, 0u, 0u);

    for (unsigned i = 0u; i < 4u; ++i) {
        TEST_ASSERT_EQUAL_HEX32(expected[i], draw_word());
    }
}

void test_a_stream_can_be_drawn_again(void)
{
    uint32_t first = first_word(7u, 1u, 2u, 3u);
    (void)draw_word();

    TEST_ASSERT_EQUAL_HEX32(first, first_word(7u, 1u, 2u, 3u));
}

void test_every_bit_of_what_picks_a_stream_picks_another(void)
{
    uint32_t plain = first_word(0u, 0u, 0u, 0u);
    for (unsigned bit = 0u; bit < 64u; ++bit) {
        TEST_ASSERT_NOT_EQUAL(plain, first_word(1ull << bit, 0u, 0u, 0u));
        TEST_ASSERT_NOT_EQUAL(plain, first_word(0u, 0u, 1ull << bit, 0u));
    }
    for (unsigned bit = 0u; bit < 32u; ++bit) {
        TEST_ASSERT_NOT_EQUAL(plain, first_word(0u, 1ull << bit, 0u, 0u));
    }
    for (unsigned bit = 0u; bit < 8u; ++bit) {
        TEST_ASSERT_NOT_EQUAL(plain, first_word(0u, 0u, 0u, 1u << bit));
    }
}

void test_a_long_stream_is_uniform_and_does_not_repeat_itself(void)
{
    sim_random_begin(&stream, 1u, 2u, 3u, 0u);
    for (unsigned i = 0u; i < N; ++i) {
        values[i] = sim_random_uniform(&stream, 1.0);
    }
    statistics_check_independent(values, &values[1], N - 1u);
    statistics_check_independent(values, &values[4], N - 4u); /* a block */
    statistics_check_uniform(values, N);
}

void test_a_width_stretches_what_is_uniform(void)
{
    sim_random_begin(&stream, 1u, 2u, 3u, 0u);
    double share = sim_random_uniform(&stream, 1.0);
    sim_random_begin(&stream, 1u, 2u, 3u, 0u);

    TEST_ASSERT_EQUAL_DOUBLE(250.0 * share, sim_random_uniform(&stream, 250.0));
}

void test_exponential_numbers_are_exponential(void)
{
    sim_random_begin(&stream, 7u, 8u, 9u, 0u);
    for (unsigned i = 0u; i < N; ++i) {
        values[i] = exp(-sim_random_exponential(&stream, 40.0) / 40.0); /* uniform, then */
    }
    statistics_check_uniform(values, N);
}

void test_normal_numbers_are_normal(void)
{
    sim_random_begin(&stream, 4u, 5u, 6u, 0u);
    for (unsigned i = 0u; i < N; ++i) {
        values[i] = sim_random_normal(&stream, 3.0) / 3.0;
    }
    statistics_check_normal(values, N);
}

void test_without_deviation_there_is_none(void)
{
    sim_random_begin(&stream, 4u, 5u, 6u, 0u);
    for (unsigned i = 0u; i < 100u; ++i) {
        TEST_ASSERT_TRUE(fabs(sim_random_normal(&stream, 0.0)) <= 0.0);
    }
}
