/*
 * skiplatch-sim: the simulation without Python. Plays touches at random instants against the
 * firmware and prints them as CSV, a row a touch.
 */
#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "api/batch.h"
#include "random.h"

#define EXIT_USAGE    2
#define TOUCHES_MAX   10000000u
#define TOUCH_GAP_S   0.8 /* from one touch to the next */
#define APPROACH_MM   5.0
#define OVERTRAVEL_MM 20.0

typedef struct {
    sim_chain_t chain;
    double      touches;
    double      feed_mm_min;
    double      seed;
    int32_t     path;
} options_t;

static const options_t DEFAULTS = {
    .chain =
        {
            .skip_latency_us = 2.0,
            .skip_jitter_us = 0.5,
            .tick_us = 0.25,
            .scan_us = 4000.0,
            .resolution_um = 0.1,
            .accel_mm_s2 = 3000.0,
            .report_latency_us = 500.0,
            .report_jitter_us = 50.0,
        },
    .touches = 10.0,
    .feed_mm_min = 3000.0,
    .seed = 1.0,
    .path = SIM_PATH_SKIP,
};

static void print_usage(FILE *stream)
{
    fputs(
        "usage: skiplatch-sim [options]\n"
        "Play touches at random instants through the firmware; print one CSV row a touch.\n\n"
        "  --path skip|plc    input path (skip)\n"
        "  --touches N        how many (10)\n"
        "  --feed MM_MIN      measuring feed in mm/min (3000)\n"
        "  --scan US          PLC scan period in us, 100 to 20000 (4000)\n"
        "  --latency US       skip input: edge to latch in us (2)\n"
        "  --jitter US        skip input: uniform addition to it in us (0.5)\n"
        "  --tick US          tick of the device clock in us (0.25)\n"
        "  --seed N           random seed (1)\n"
        "  --help             this text\n\n"
        "example: skiplatch-sim --path plc --scan 4000 --feed 3000 --touches 1000 > touches.csv\n",
        stream);
}

static bool parse_number(const char *text, double *value)
{
    char *end = NULL;
    errno = 0;
    *value = strtod(text, &end);
    return errno == 0 && end != text && *end == '\0' && isfinite(*value);
}

static bool parse_path(const char *text, int32_t *path)
{
    *path = strcmp(text, "plc") == 0 ? SIM_PATH_PLC : SIM_PATH_SKIP;
    return *path == SIM_PATH_PLC || strcmp(text, "skip") == 0;
}

static bool apply_option(options_t *options, int name, const char *text)
{
    switch (name) {
    case 'p':
        return parse_path(text, &options->path);
    case 'n':
        return parse_number(text, &options->touches) && options->touches >= 1.0 &&
               options->touches <= TOUCHES_MAX;
    case 'f':
        return parse_number(text, &options->feed_mm_min);
    case 's':
        return parse_number(text, &options->chain.scan_us);
    case 'l':
        return parse_number(text, &options->chain.skip_latency_us);
    case 'j':
        return parse_number(text, &options->chain.skip_jitter_us);
    case 't':
        return parse_number(text, &options->chain.tick_us);
    case 'r':
        return parse_number(text, &options->seed) && options->seed >= 0.0;
    default:
        return false;
    }
}

/* Begin each touch at a random instant, so that the edge falls anywhere in a scan. */
static void fill_touches(const options_t *options, sim_touch_t *touches, uint64_t n)
{
    sim_random_t random;
    sim_random_begin(&random, (uint64_t)options->seed, UINT32_MAX, UINT64_MAX, 0u);
    for (uint64_t i = 0; i < n; ++i) {
        touches[i] = (sim_touch_t){
            .time_s = TOUCH_GAP_S * (double)i + sim_random_uniform(&random, TOUCH_GAP_S / 4.0),
            .feed_mm_min = options->feed_mm_min,
            .approach_mm = APPROACH_MM,
            .touch = i,
            .path = options->path,
        };
    }
}

static void print_outcomes(const sim_outcome_t *outcomes, uint64_t n)
{
    puts("touch,edge_us,latch_us,report_us,deviation_um,overtravel_um,cycle_s,status");
    for (uint64_t i = 0; i < n; ++i) {
        const sim_outcome_t *o = &outcomes[i];
        printf("%llu,%.3f,%.3f,%.3f,%.3f,%.3f,%.6f,%s\n", (unsigned long long)i, o->edge_us,
               o->latch_us, o->report_us, o->deviation_um, o->overtravel_um, o->cycle_s,
               o->status == SIM_STATUS_OK ? "ok" : "missed");
    }
}

static int run(const options_t *options)
{
    const sim_controller_t controller = {.overtravel_mm = OVERTRAVEL_MM};
    const sim_rig_t        rig = {
        .chain = &options->chain, .controller = &controller, .seed = (uint64_t)options->seed};
    uint64_t       n = (uint64_t)options->touches;
    sim_touch_t   *touches = calloc(n, sizeof *touches);
    sim_outcome_t *outcomes = calloc(n, sizeof *outcomes);
    int            result = SIM_PLAY_ERR_MEMORY;

    if (touches != NULL && outcomes != NULL) {
        fill_touches(options, touches, n);
        result = sim_play(&rig, touches, n, 1u, 1u, outcomes);
    }
    if (result == SIM_PLAY_OK) {
        print_outcomes(outcomes, n);
    } else {
        fprintf(stderr, "skiplatch-sim: %s\n", sim_play_error(result));
    }
    free(outcomes);
    free(touches);
    return result == SIM_PLAY_OK ? EXIT_SUCCESS : EXIT_USAGE;
}

int main(int argc, char **argv)
{
    static const struct option names[] = {
        {"path", required_argument, NULL, 'p'},    {"touches", required_argument, NULL, 'n'},
        {"feed", required_argument, NULL, 'f'},    {"scan", required_argument, NULL, 's'},
        {"latency", required_argument, NULL, 'l'}, {"jitter", required_argument, NULL, 'j'},
        {"tick", required_argument, NULL, 't'},    {"seed", required_argument, NULL, 'r'},
        {"help", no_argument, NULL, 'h'},          {NULL, 0, NULL, 0},
    };
    options_t options = DEFAULTS;
    int       name;
    while ((name = getopt_long(argc, argv, "", names, NULL)) != -1) {
        if (name == 'h') {
            print_usage(stdout);
            return EXIT_SUCCESS;
        }
        if (name == '?') { /* getopt has said why */
            return EXIT_USAGE;
        }
        if (!apply_option(&options, name, optarg)) {
            fprintf(stderr, "skiplatch-sim: bad value \"%s\"; see --help\n", optarg);
            return EXIT_USAGE;
        }
    }
    if (optind < argc) {
        fprintf(stderr, "skiplatch-sim: unexpected argument \"%s\"; see --help\n", argv[optind]);
        return EXIT_USAGE;
    }
    return run(&options);
}
