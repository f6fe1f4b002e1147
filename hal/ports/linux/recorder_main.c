/*
 * skiplatch-recorder: the pulses of two encoders on GPIO lines into a file that
 * `skiplatch transmission` reads. Says "ready" when it listens. Where pulses were lost, or the chip
 * has gone, it ends with what came before: a file has no gaps.
 */
#include <errno.h>
#include <getopt.h>
#include <inttypes.h>
#include <poll.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "clock.h"
#include "hal_error.h"
#include "hal_pulse.h"
#include "pulse.h"
#include "pulse_file.h"
#include "say.h"
#include "signals.h"

#define EXIT_USAGE 2
#define LINE_MAX   100000
#define WAIT_MS    100

typedef struct {
    pulse_lines_t lines;
    const char   *out;
    uint64_t      pulses; /* after which to end; 0: never */
    bool          has_lines[HAL_PULSE_CHANNELS];
    bool          has_help;
} recorder_options_t;

static void print_help(void)
{
    fputs("usage: skiplatch-recorder --chip CHIP --input LINE --output LINE --out FILE.bin\n"
          "Record the rising edges of two encoders with the kernel's stamps, for\n"
          "`skiplatch transmission FILE.bin`. Ends on Ctrl-C, or when pulses were lost.\n\n"
          "  --chip CHIP     GPIO chip: a path, a name below /dev, or a label\n"
          "  --input LINE    line of the input's encoder\n"
          "  --output LINE   line of the output's encoder\n"
          "  --out FILE.bin  the file to write\n"
          "  --pulses N      end after so many\n"
          "  --help          this text\n\n"
          "example: skiplatch-recorder --chip gpiochip0 --input 17 --output 27 --out run.bin\n",
          stdout);
}

/* ---- the command line ---- */

static bool parse_number(const char *text, uint64_t most, uint64_t *number)
{
    char *end = NULL;
    errno = 0;
    *number = strtoull(text, &end, 10);
    return end != text && *end == '\0' && text[0] != '-' && errno == 0 && *number <= most;
}

static bool set_line(recorder_options_t *options, unsigned channel, const char *text)
{
    uint64_t line = 0u;
    options->has_lines[channel] = parse_number(text, LINE_MAX, &line);
    options->lines.offsets[channel] = (uint32_t)line;
    return options->has_lines[channel];
}

static bool apply_option(recorder_options_t *options, int name, const char *text)
{
    switch (name) {
    case 'c':
        options->lines.chip = text;
        return true;
    case 'i':
        return set_line(options, 0u, text);
    case 'o':
        return set_line(options, 1u, text);
    case 'f':
        options->out = text;
        return true;
    case 'n':
        return parse_number(text, UINT64_MAX, &options->pulses);
    default:
        options->has_help = true;
        return true;
    }
}

static bool is_complete(const recorder_options_t *options)
{
    if (options->has_help) {
        return true;
    }
    if (options->lines.chip == NULL || options->out == NULL || !options->has_lines[0] ||
        !options->has_lines[1]) {
        say("--chip, --input, --output and --out are needed; see --help");
        return false;
    }
    if (options->lines.offsets[0] == options->lines.offsets[1]) {
        say("--input and --output are the same line");
        return false;
    }
    return true;
}

static bool parse(recorder_options_t *options, int argc, char **argv)
{
    static const struct option NAMES[] = {
        {"chip", required_argument, NULL, 'c'},
        {"input", required_argument, NULL, 'i'},
        {"output", required_argument, NULL, 'o'},
        {"out", required_argument, NULL, 'f'},
        {"pulses", required_argument, NULL, 'n'},
        {"help", no_argument, NULL, 'h'},
        {NULL, 0, NULL, 0},
    };
    int name;
    int index = 0;
    *options = (recorder_options_t){.lines = {.consumer = "skiplatch-recorder"}};
    while ((name = getopt_long(argc, argv, "", NAMES, &index)) != -1) {
        if (name == '?') { /* getopt has said why */
            return false;
        }
        if (!apply_option(options, name, optarg)) {
            say("--%s: bad value \"%s\"; see --help", NAMES[index].name, optarg);
            return false;
        }
    }
    if (optind < argc) {
        say("unexpected argument \"%s\"; see --help", argv[optind]);
        return false;
    }
    return is_complete(options);
}

/* ---- recording ---- */

/* A stamp is less old than the ticks take to go round. */
static uint64_t stamp_ns(uint32_t captured_ticks)
{
    uint64_t now_ns = clock_now_ns();
    uint64_t ago_ticks = (uint32_t)(clock_ticks_of_ns(now_ns) - captured_ticks);
    return (now_ns / CLOCK_TICK_NS - ago_ticks) * CLOCK_TICK_NS;
}

/* True as long as there is more to record. */
static bool take_pulses(pulse_file_t *file, uint64_t most, int *error)
{
    hal_pulse_t pulse;
    while (hal_pulse_take(&pulse)) {
        if (pulse.lost != 0u) {
            say("at least %u pulses were lost; the file ends before them", pulse.lost);
            *error = EOVERFLOW;
            return false;
        }
        *error = pulse_file_add(file, pulse.channel, stamp_ns(pulse.captured_ticks));
        if (*error != 0) {
            say("cannot write: %s", strerror(*error));
            return false;
        }
        if (most != 0u && file->count + file->held == most) {
            return false;
        }
    }
    *error = pulse_error();
    if (*error != 0) {
        say("the lines are gone: %s", strerror(*error));
    }
    return *error == 0;
}

static int record(pulse_file_t *file, uint64_t most, int signals)
{
    int           error = 0;
    struct pollfd watched[] = {{.fd = pulse_fd(), .events = POLLIN},
                               {.fd = signals, .events = POLLIN}};
    do {
        (void)poll(watched, sizeof watched / sizeof *watched, WAIT_MS);
    } while (take_pulses(file, most, &error) && !signals_take(signals).end);
    return error;
}

static int run(const recorder_options_t *options, int signals)
{
    pulse_file_t file;
    if (pulse_open(&options->lines) != 0) {
        return EXIT_USAGE;
    }
    int error = pulse_file_open(&file, options->out);
    if (error != 0) {
        say("%s: cannot write: %s", options->out, strerror(error));
        return EXIT_USAGE;
    }
    if (hal_pulse_start(HAL_PULSE_RISING) != HAL_OK) {
        say("the lines were taken by another program");
        error = EBUSY;
    } else {
        puts("ready");
        (void)fflush(stdout);
        error = record(&file, options->pulses, signals);
        hal_pulse_stop();
    }
    int closing = pulse_file_close(&file);
    if (closing != 0) {
        say("%s: cannot write: %s", options->out, strerror(closing));
    }
    printf("{\"pulses\": %" PRIu64 "}\n", file.count);
    return error == 0 && closing == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

int main(int argc, char **argv)
{
    recorder_options_t options;
    say_as("skiplatch-recorder");
    if (!parse(&options, argc, argv)) {
        return EXIT_USAGE;
    }
    if (options.has_help) {
        print_help();
        return EXIT_SUCCESS;
    }
    int signals = signals_start();
    if (signals < 0) {
        say("no signals: %s", strerror(-signals));
        return EXIT_FAILURE;
    }
    return run(&options, signals);
}
