/* hal/ports/linux/options.h: the command line of skiplatch-controller. */
/* LINK: hal/ports/linux/options.c hal/ports/linux/say.c */
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "../hal/ports/linux/options.h"
#include "unity.h"

#define WORDS_MAX  32
#define TEXT_BYTES 4096

static options_t options;
static char      said[TEXT_BYTES];

void setUp(void)
{
    memset(said, 0, sizeof said);
}

void tearDown(void)
{
}

/* Read the words, apart at blanks, and keep what was said on the error stream. */
static options_result_t parse(const char *words)
{
    static char line[TEXT_BYTES];
    char        program[] = "skiplatch-controller";
    char       *argv[WORDS_MAX] = {program};
    int         argc = 1;
    (void)snprintf(line, sizeof line, "%s", words);
    for (char *word = strtok(line, " "); word != NULL; word = strtok(NULL, " ")) {
        argv[argc++] = word;
    }
    FILE *caught = tmpfile();
    int   kept = dup(STDERR_FILENO);
    (void)dup2(fileno(caught), STDERR_FILENO);
    options_result_t result = options_parse(argc, argv, &options);
    (void)dup2(kept, STDERR_FILENO);
    (void)close(kept);
    rewind(caught);
    said[fread(said, 1u, sizeof said - 1u, caught)] = '\0';
    (void)fclose(caught);
    return result;
}

/* What has to be there, and then `more`. */
static options_result_t parse_more(const char *more)
{
    char words[TEXT_BYTES];
    (void)snprintf(words, sizeof words, "--chip gpiochip0 --line 3 --can can0 %s", more);
    return parse(words);
}

static void check_refused(const char *more, const char *named)
{
    TEST_ASSERT_EQUAL_INT_MESSAGE(OPTIONS_BAD, parse_more(more), more);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(said, named), said);
    TEST_ASSERT_EQUAL_PTR_MESSAGE(strchr(said, '\n'), said + strlen(said) - 1, "not one line");
}

static void check_taken(const char *more)
{
    TEST_ASSERT_EQUAL_INT_MESSAGE(OPTIONS_RUN, parse_more(more), said);
    TEST_ASSERT_EQUAL_STRING("", said);
}

void test_chip_line_and_interface_are_enough(void)
{
    check_taken("");

    TEST_ASSERT_EQUAL_STRING("gpiochip0", options.line.chip);
    TEST_ASSERT_EQUAL_UINT32(3u, options.line.offset);
    TEST_ASSERT_EQUAL_STRING("can0", options.can);
    TEST_ASSERT_EQUAL_HEX32(0x181u, options.latch_id);
    TEST_ASSERT_FALSE(options.is_plc);
    TEST_ASSERT_EQUAL_UINT32(4000u, options.scan_us);
    TEST_ASSERT_EQUAL_INT(EDGE_BIAS_AS_IS, options.line.bias);
    TEST_ASSERT_EQUAL_INT(EDGE_CLOCK_MONOTONIC, options.line.event_clock);
    TEST_ASSERT_EQUAL_UINT32(0u, options.line.debounce_us);
    TEST_ASSERT_LESS_THAN_INT(0, options.cpu);
    TEST_ASSERT_EQUAL_INT(0, options.fifo_priority);
    TEST_ASSERT_FALSE(options.lock_memory);
    TEST_ASSERT_EQUAL_UINT64(0u, options.touches);
}

void test_every_option_is_taken(void)
{
    check_taken("--path plc --scan-us 1000 --debounce-us 50 --bias pull-up --active-low "
                "--event-clock realtime --latch-id 0x2FF --feed 3000 --resolution-um 0.5 --cpu 1 "
                "--fifo 80 --lock-memory --touches 100000");

    TEST_ASSERT_TRUE(options.is_plc);
    TEST_ASSERT_EQUAL_UINT32(1000u, options.scan_us);
    TEST_ASSERT_EQUAL_UINT32(50u, options.line.debounce_us);
    TEST_ASSERT_EQUAL_INT(EDGE_BIAS_PULL_UP, options.line.bias);
    TEST_ASSERT_TRUE(options.line.active_low);
    TEST_ASSERT_EQUAL_INT(EDGE_CLOCK_REALTIME, options.line.event_clock);
    TEST_ASSERT_EQUAL_HEX32(0x2FFu, options.latch_id);
    TEST_ASSERT_EQUAL_DOUBLE(3000.0, options.feed_mm_min);
    TEST_ASSERT_EQUAL_DOUBLE(0.5, options.resolution_um);
    TEST_ASSERT_EQUAL_INT(1, options.cpu);
    TEST_ASSERT_EQUAL_INT(80, options.fifo_priority);
    TEST_ASSERT_TRUE(options.lock_memory);
    TEST_ASSERT_EQUAL_UINT64(100000u, options.touches);
}

void test_each_bias_has_its_word(void)
{
    check_taken("--bias disabled");
    TEST_ASSERT_EQUAL_INT(EDGE_BIAS_DISABLED, options.line.bias);
    check_taken("--bias pull-down");
    TEST_ASSERT_EQUAL_INT(EDGE_BIAS_PULL_DOWN, options.line.bias);
    check_taken("--bias as-is");
    TEST_ASSERT_EQUAL_INT(EDGE_BIAS_AS_IS, options.line.bias);
}

void test_what_has_to_be_there_is_asked_for(void)
{
    TEST_ASSERT_EQUAL_INT(OPTIONS_BAD, parse("--line 3 --can can0"));
    TEST_ASSERT_NOT_NULL(strstr(said, "--chip is missing"));
    TEST_ASSERT_EQUAL_INT(OPTIONS_BAD, parse("--chip gpiochip0 --can can0"));
    TEST_ASSERT_NOT_NULL(strstr(said, "--line is missing"));
    TEST_ASSERT_EQUAL_INT(OPTIONS_BAD, parse("--chip gpiochip0 --line 3"));
    TEST_ASSERT_NOT_NULL(strstr(said, "--can is missing"));
}

void test_both_sides_of_every_bound(void)
{
    check_taken("--scan-us 100");
    check_refused("--scan-us 99", "--scan-us");
    check_taken("--scan-us 20000");
    check_refused("--scan-us 20001", "--scan-us");
    check_taken("--debounce-us 65535");
    check_refused("--debounce-us 65536", "--debounce-us");
    check_taken("--latch-id 0x1FFFFFFF");
    check_refused("--latch-id 0x20000000", "--latch-id");
    check_taken("--fifo 1");
    check_refused("--fifo 0", "--fifo");
    check_taken("--fifo 99");
    check_refused("--fifo 100", "--fifo");
    check_taken("--touches 1");
    check_refused("--touches 0", "--touches");
    check_taken("--feed 100000");
    check_refused("--feed 100000.5", "--feed");
    check_refused("--feed 0", "--feed");
    check_refused("--resolution-um 0", "--resolution-um");
}

void test_a_number_with_a_0_before_it_is_decimal(void)
{
    TEST_ASSERT_EQUAL_INT(OPTIONS_RUN,
                          parse("--chip gpiochip0 --line 010 --can can0 --latch-id 0X0FF"));
    TEST_ASSERT_EQUAL_UINT32(10u, options.line.offset);
    TEST_ASSERT_EQUAL_HEX32(0xFFu, options.latch_id);
    check_taken("--touches 09");
}

void test_what_is_no_number_is_refused(void)
{
    static const char *const TEXTS[] = {"x", "4k", "-1", "1.5", "0x", "99999999999999999999"};
    char                     more[64];
    for (size_t i = 0u; i < sizeof TEXTS / sizeof *TEXTS; ++i) {
        (void)snprintf(more, sizeof more, "--scan-us %s", TEXTS[i]);
        check_refused(more, TEXTS[i]);
    }
    check_refused("--feed nan", "--feed");
    check_refused("--feed inf", "--feed");
}

void test_what_is_no_known_word_is_refused(void)
{
    check_refused("--path PLC", "\"PLC\" for --path");
    check_refused("--bias up", "\"up\" for --bias");
    check_refused("--event-clock hte", "\"hte\" for --event-clock");
}

void test_unknown_options_and_stray_words_are_refused(void)
{
    check_refused("--bogus", "bogus");
    check_refused("stray", "unexpected argument \"stray\"");
    check_refused("--scan-us", "scan-us");
}

/* getopt writes the place of an option into a table of its own when it is shortened, too. */
void test_a_shortened_option_is_named_in_full(void)
{
    check_refused("--debounce x", "--debounce-us");
}
