#include "options.h"

#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "say.h"

#define SCAN_MIN_US     100u
#define SCAN_MAX_US     20000u
#define DEBOUNCE_MAX_US 65535u
#define OFFSET_MAX      65535u
#define CAN_ID_MAX      0x1FFFFFFFu
#define CPU_MAX         1023u
#define PRIORITY_MIN    1u
#define PRIORITY_MAX    99u
#define FEED_MAX_MM_MIN 100000.0
#define RESOLUTION_MAX  1000.0
#define NO_OFFSET       UINT32_MAX

enum {
    CHIP = 256,
    LINE,
    CAN,
    PATH,
    SCAN,
    DEBOUNCE,
    BIAS,
    ACTIVE_LOW,
    EVENT_CLOCK,
    LATCH_ID,
    FEED,
    RESOLUTION,
    CPU,
    FIFO,
    LOCK_MEMORY,
    TOUCHES,
    HELP
};

static const struct option NAMES[] = {
    {"chip", required_argument, NULL, CHIP},
    {"line", required_argument, NULL, LINE},
    {"can", required_argument, NULL, CAN},
    {"path", required_argument, NULL, PATH},
    {"scan-us", required_argument, NULL, SCAN},
    {"debounce-us", required_argument, NULL, DEBOUNCE},
    {"bias", required_argument, NULL, BIAS},
    {"active-low", no_argument, NULL, ACTIVE_LOW},
    {"event-clock", required_argument, NULL, EVENT_CLOCK},
    {"latch-id", required_argument, NULL, LATCH_ID},
    {"feed", required_argument, NULL, FEED},
    {"resolution-um", required_argument, NULL, RESOLUTION},
    {"cpu", required_argument, NULL, CPU},
    {"fifo", required_argument, NULL, FIFO},
    {"lock-memory", no_argument, NULL, LOCK_MEMORY},
    {"touches", required_argument, NULL, TOUCHES},
    {"help", no_argument, NULL, HELP},
    {NULL, 0, NULL, 0},
};

static const options_t DEFAULTS = {
    .line = {.offset = NO_OFFSET, .consumer = "skiplatch-controller"},
    .latch_id = 0x181u,
    .scan_us = 4000u,
    .feed_mm_min = 600.0,
    .resolution_um = 0.1,
    .cpu = -1,
};

static void print_usage(void)
{
    fputs("usage: skiplatch-controller --chip CHIP --line OFFSET --can IFACE [options]\n"
          "Watch a GPIO line, latch its edges, send latch records as CAN frames.\n"
          "Prints \"ready\" once armed, and its counters as JSON at the end and on SIGUSR1.\n\n"
          "  --chip CHIP          /dev/gpiochipN, gpiochipN, or the chip's label\n"
          "  --line OFFSET        line of that chip\n"
          "  --can IFACE          CAN interface, e.g. can0\n"
          "  --path skip|plc      edge with the kernel's stamp, or a polling scan (skip)\n"
          "  --scan-us N          scan period of the PLC path, 100 to 20000 (4000)\n"
          "  --debounce-us N      debounce in the chip or the kernel, 0 to 65535 (0)\n"
          "  --bias pull-up|pull-down|disabled   (as it is)\n"
          "  --active-low         the line is low while the probe is deflected\n"
          "  --event-clock monotonic|realtime    clock of the kernel's stamps (monotonic)\n"
          "  --latch-id ID        CAN identifier of latch frames (0x181)\n"
          "  --feed MM_MIN        speed of the virtual axis (600)\n"
          "  --resolution-um UM   its count (0.1)\n"
          "  --cpu N              run on processor N only\n"
          "  --fifo PRIORITY      real-time priority 1 to 99\n"
          "  --lock-memory        keep memory from being paged out\n"
          "  --touches N          end after N latches\n"
          "  --help               this text\n\n"
          "example: skiplatch-controller --chip gpiochip0 --line 0 --can can0 --path skip\n",
          stdout);
}

/* Decimal, or hexadecimal after 0x; a 0 before it means nothing. */
static bool parse_whole(const char *text, uint64_t least, uint64_t most, uint64_t *value)
{
    char *end = NULL;
    bool  is_hexadecimal = text[0] == '0' && (text[1] == 'x' || text[1] == 'X');
    errno = 0;
    *value = strtoull(text, &end, is_hexadecimal ? 16 : 10);
    return errno == 0 && end != text && *end == '\0' && strchr(text, '-') == NULL &&
           *value >= least && *value <= most;
}

static bool parse_u32(const char *text, uint32_t least, uint32_t most, uint32_t *value)
{
    uint64_t whole = 0u;
    bool     is_good = parse_whole(text, least, most, &whole);
    *value = (uint32_t)whole;
    return is_good;
}

static bool parse_int(const char *text, uint32_t least, uint32_t most, int *value)
{
    uint32_t whole = 0u;
    bool     is_good = parse_u32(text, least, most, &whole);
    *value = (int)whole;
    return is_good;
}

/* Above 0, and `most` at most. */
static bool parse_positive(const char *text, double most, double *value)
{
    char *end = NULL;
    errno = 0;
    *value = strtod(text, &end);
    return errno == 0 && end != text && *end == '\0' && isfinite(*value) && *value > 0.0 &&
           *value <= most;
}

/* The place of `text` among the words, or −1. */
static int word(const char *text, const char *const *words)
{
    for (int i = 0; words[i] != NULL; ++i) {
        if (strcmp(text, words[i]) == 0) {
            return i;
        }
    }
    return -1;
}

static bool parse_path(const char *text, bool *is_plc)
{
    static const char *const WORDS[] = {"skip", "plc", NULL};
    int                      place = word(text, WORDS);
    *is_plc = place == 1;
    return place >= 0;
}

static bool parse_clock(const char *text, edge_clock_t *event_clock)
{
    static const char *const WORDS[] = {"monotonic", "realtime", NULL};
    int                      place = word(text, WORDS);
    *event_clock = place == 1 ? EDGE_CLOCK_REALTIME : EDGE_CLOCK_MONOTONIC;
    return place >= 0;
}

static bool parse_bias(const char *text, edge_bias_t *bias)
{
    static const char *const WORDS[] = {"as-is", "disabled", "pull-up", "pull-down", NULL};
    int                      place = word(text, WORDS);
    *bias = place >= 0 ? (edge_bias_t)place : EDGE_BIAS_AS_IS;
    return place >= 0;
}

static bool apply_line(options_t *options, int name, const char *text)
{
    switch (name) {
    case CHIP:
        options->line.chip = text;
        return *text != '\0';
    case LINE:
        return parse_u32(text, 0u, OFFSET_MAX, &options->line.offset);
    case DEBOUNCE:
        return parse_u32(text, 0u, DEBOUNCE_MAX_US, &options->line.debounce_us);
    case BIAS:
        return parse_bias(text, &options->line.bias);
    case ACTIVE_LOW:
        options->line.active_low = true;
        return true;
    case EVENT_CLOCK:
        return parse_clock(text, &options->line.event_clock);
    default:
        return false;
    }
}

static bool apply_realtime(options_t *options, int name, const char *text)
{
    switch (name) {
    case CPU:
        return parse_int(text, 0u, CPU_MAX, &options->cpu);
    case FIFO:
        return parse_int(text, PRIORITY_MIN, PRIORITY_MAX, &options->fifo_priority);
    case LOCK_MEMORY:
        options->lock_memory = true;
        return true;
    default:
        return apply_line(options, name, text);
    }
}

static bool apply(options_t *options, int name, const char *text)
{
    switch (name) {
    case CAN:
        options->can = text;
        return *text != '\0';
    case PATH:
        return parse_path(text, &options->is_plc);
    case SCAN:
        return parse_u32(text, SCAN_MIN_US, SCAN_MAX_US, &options->scan_us);
    case LATCH_ID:
        return parse_u32(text, 0u, CAN_ID_MAX, &options->latch_id);
    case FEED:
        return parse_positive(text, FEED_MAX_MM_MIN, &options->feed_mm_min);
    case RESOLUTION:
        return parse_positive(text, RESOLUTION_MAX, &options->resolution_um);
    case TOUCHES:
        return parse_whole(text, 1u, UINT64_MAX, &options->touches);
    default:
        return apply_realtime(options, name, text);
    }
}

static bool has_what_it_needs(const options_t *options)
{
    const char *missing = NULL;
    if (options->line.chip == NULL) {
        missing = "--chip";
    } else if (options->line.offset == NO_OFFSET) {
        missing = "--line";
    } else if (options->can == NULL) {
        missing = "--can";
    }
    if (missing != NULL) {
        say("%s is missing; see --help", missing);
    }
    return missing == NULL;
}

options_result_t options_parse(int argc, char **argv, options_t *options)
{
    int name = 0;
    int place = 0;
    *options = DEFAULTS;
    optind = 0; /* begin anew, whoever read a command line before */
    while ((name = getopt_long(argc, argv, "", NAMES, &place)) != -1) { /* NOLINT: one thread */
        if (name == HELP) {
            print_usage();
            return OPTIONS_HELP;
        }
        if (name == '?') { /* getopt has said why */
            return OPTIONS_BAD;
        }
        if (!apply(options, name, optarg)) {
            say("bad value \"%s\" for --%s; see --help", optarg, NAMES[place].name);
            return OPTIONS_BAD;
        }
    }
    if (optind < argc) {
        say("unexpected argument \"%s\"; see --help", argv[optind]);
        return OPTIONS_BAD;
    }
    return has_what_it_needs(options) ? OPTIONS_RUN : OPTIONS_BAD;
}
