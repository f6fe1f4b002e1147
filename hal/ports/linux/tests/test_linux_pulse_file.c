/* hal/ports/linux/pulse_file.h: the bytes that `skiplatch transmission` reads. */
/* LINK: hal/ports/linux/pulse_file.c */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "../hal/ports/linux/pulse_file.h"
#include "unity.h"

#define PULSES 1000u
#define HEAD   16u
#define WORD   8u

static char         path[] = "/tmp/pulse_file_XXXXXX";
static pulse_file_t pulses;
static uint8_t      bytes[HEAD + WORD * PULSES + 1u];

void setUp(void)
{
    memcpy(path + sizeof path - 7u, "XXXXXX", 6u);
    (void)close(mkstemp(path));
    TEST_ASSERT_EQUAL_INT(0, pulse_file_open(&pulses, path));
}

void tearDown(void)
{
    (void)unlink(path);
}

static size_t read_back(void)
{
    FILE  *file = fopen(path, "rb");
    size_t size = fread(bytes, 1u, sizeof bytes, file);
    (void)fclose(file);
    return size;
}

static uint64_t word_at(size_t place)
{
    uint64_t word = 0u;
    for (unsigned i = 0u; i < WORD; ++i) {
        word |= (uint64_t)bytes[place + i] << 8u * i;
    }
    return word;
}

static void add(uint8_t channel, uint64_t t_ns)
{
    TEST_ASSERT_EQUAL_INT(0, pulse_file_add(&pulses, channel, t_ns));
}

void test_a_pulse_is_its_time_and_its_channel(void)
{
    add(0u, 1234567890123u);
    add(1u, 1234567890124u);
    TEST_ASSERT_EQUAL_INT(0, pulse_file_close(&pulses));

    TEST_ASSERT_EQUAL_UINT(HEAD + 2u * WORD, read_back());
    TEST_ASSERT_EQUAL_MEMORY("SKLPULS1\2\0\0\0\0\0\0\0", bytes, HEAD);
    TEST_ASSERT_EQUAL_UINT64(1234567890123u, word_at(HEAD));
    TEST_ASSERT_EQUAL_UINT64(1234567890124u | UINT64_C(1) << 61, word_at(HEAD + WORD));
}

/* Pulses of two lines that have changed places, by up to so many. */
void test_pulses_come_into_order(void)
{
    for (unsigned i = 0u; i < PULSES; ++i) {
        unsigned t = i / 10u * 10u + (9u - i % 10u);
        add(t % 2u, 100u * t);
    }
    TEST_ASSERT_EQUAL_INT(0, pulse_file_close(&pulses));

    TEST_ASSERT_EQUAL_UINT(HEAD + WORD * PULSES, read_back());
    TEST_ASSERT_EQUAL_UINT64(PULSES, word_at(8u));
    for (unsigned i = 0u; i < PULSES; ++i) {
        TEST_ASSERT_EQUAL_UINT64(100u * i | (uint64_t)(i % 2u) << 61, word_at(HEAD + WORD * i));
    }
}

void test_a_file_that_nobody_closed_announces_nothing(void)
{
    for (unsigned i = 0u; i < PULSES; ++i) {
        add(0u, i);
    }
    (void)fflush(pulses.file);

    (void)read_back();
    TEST_ASSERT_EQUAL_UINT64(0u, word_at(8u));
    TEST_ASSERT_EQUAL_INT(0, pulse_file_close(&pulses));
}

void test_a_full_disk_is_told(void)
{
    pulse_file_t full;
    TEST_ASSERT_EQUAL_INT(0, pulse_file_open(&full, "/dev/full"));
    add(0u, 1u);
    TEST_ASSERT_EQUAL_INT(0, pulse_file_add(&full, 0u, 1u));

    TEST_ASSERT_EQUAL_INT(ENOSPC, pulse_file_close(&full));
    TEST_ASSERT_EQUAL_INT(0, pulse_file_close(&pulses));
}

void test_a_folder_that_is_not_there_is_told(void)
{
    pulse_file_t nowhere;

    TEST_ASSERT_EQUAL_INT(ENOENT, pulse_file_open(&nowhere, "/nowhere/at/all"));
    TEST_ASSERT_EQUAL_INT(0, pulse_file_close(&pulses));
}
