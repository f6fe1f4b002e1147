#include "injector_options.h"

#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "say.h"

#define CPU_MAX      4095
#define PRIORITY_MAX 99

void injector_options_print_help(void)
{
    fputs(
        "usage: skiplatch-injector --can IFACE (--line CHIP:OFFSET | --sim-pull FILE) [options]\n"
        "Drive trigger lines as CAN frames ask for it (docs/INJECTION.md), and report the time of\n"
        "each edge. Prints \"ready\" when it listens, and its counters as JSON when it ends.\n\n"
        "  --can IFACE         CAN interface, such as can0 or vcan0\n"
        "  --line CHIP:OFFSET  drive this output line; up to 8 lines, numbered as given from 0\n"
        "  --sim-pull FILE     or pull this line of gpio-sim:\n"
        "                      /sys/devices/platform/gpio-sim.N/gpiochipM/sim_gpioK/pull\n"
        "  --key FILE          obey ARM and TRIGGER only under this key: 32 hexadecimal digits\n"
        "  --rest 0|1          level before the first pulse (0)\n"
        "  --cpu N             run on processor N only\n"
        "  --fifo PRIORITY     SCHED_FIFO at this priority, 1 to 99\n"
        "  --help              this text\n\n"
        "example: skiplatch-injector --can vcan0 --line gpiochip0:17 --fifo 80\n",
        stdout);
}

static bool parse_number(const char *text, int low, int high, int *number)
{
    char *end = NULL;
    long  value = strtol(text, &end, 10);
    *number = (int)value;
    return end != text && *end == '\0' && value >= low && value <= high;
}

static bool add_line(injector_options_t *options, const char *name, bool is_pull)
{
    if (options->line_count == INJECT_LINES) {
        return false;
    }
    options->lines[options->line_count] = (injector_line_name_t){name, is_pull};
    ++options->line_count;
    return true;
}

static bool apply_option(injector_options_t *options, int name, const char *text)
{
    switch (name) {
    case 'c':
        options->interface = text;
        return true;
    case 'l':
        return add_line(options, text, false);
    case 's':
        return add_line(options, text, true);
    case 'k':
        options->key_path = text;
        return true;
    case 'r':
        options->rest = strcmp(text, "1") == 0;
        return options->rest || strcmp(text, "0") == 0;
    case 'p':
        return parse_number(text, 0, CPU_MAX, &options->cpu);
    case 'f':
        return parse_number(text, 1, PRIORITY_MAX, &options->priority);
    default:
        options->has_help = true;
        return true;
    }
}

static bool is_complete(const injector_options_t *options)
{
    if (options->has_help) {
        return true;
    }
    if (options->interface == NULL) {
        say("--can is missing; see --help");
        return false;
    }
    if (options->line_count == 0u) {
        say("--line or --sim-pull is missing; see --help");
        return false;
    }
    return true;
}

bool injector_options_parse(injector_options_t *options, int argc, char **argv)
{
    static const struct option names[] = {
        {"can", required_argument, NULL, 'c'},
        {"line", required_argument, NULL, 'l'},
        {"sim-pull", required_argument, NULL, 's'},
        {"rest", required_argument, NULL, 'r'},
        {"cpu", required_argument, NULL, 'p'},
        {"fifo", required_argument, NULL, 'f'},
        {"key", required_argument, NULL, 'k'},
        {"help", no_argument, NULL, 'h'},
        {NULL, 0, NULL, 0},
    };
    *options = (injector_options_t){.cpu = -1};
    int name;
    int index = 0;
    while ((name = getopt_long(argc, argv, "", names, &index)) != -1) {
        if (name == '?') { /* getopt has said why */
            return false;
        }
        if (!apply_option(options, name, optarg)) {
            say("--%s: bad value \"%s\"; see --help", names[index].name, optarg);
            return false;
        }
    }
    if (optind < argc) {
        say("unexpected argument \"%s\"; see --help", argv[optind]);
        return false;
    }
    return is_complete(options);
}
