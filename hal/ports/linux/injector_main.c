/* skiplatch-injector: drives trigger lines as CAN frames ask for it. */
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>

#include "can_socket.h"
#include "injector.h"
#include "injector_key.h"
#include "injector_options.h"
#include "realtime.h"
#include "say.h"

static volatile sig_atomic_t is_ending;

static void on_signal(int number)
{
    (void)number;
    is_ending = 1;
}

/* Signals come only while the loop sleeps, so that none is overlooked between look and sleep. */
static void catch_signals(sigset_t *sleeping)
{
    const struct sigaction action = {.sa_handler = on_signal};
    sigset_t               blocked;
    (void)sigemptyset(&blocked);
    (void)sigaddset(&blocked, SIGINT);
    (void)sigaddset(&blocked, SIGTERM);
    (void)sigprocmask(SIG_BLOCK, &blocked, sleeping);
    (void)sigdelset(sleeping, SIGINT);
    (void)sigdelset(sleeping, SIGTERM);
    (void)sigaction(SIGINT, &action, NULL);
    (void)sigaction(SIGTERM, &action, NULL);
}

static bool open_lines(injector_t *injector, const injector_options_t *options)
{
    for (uint8_t i = 0u; i < options->line_count; ++i) {
        const injector_line_name_t *line = &options->lines[i];
        bool                        is_open =
            line->is_pull
                ? injector_line_open_pull(&injector->lines[i], line->name, options->rest)
                : injector_line_open_output(&injector->lines[i], line->name, options->rest);
        if (!is_open) {
            return false;
        }
    }
    return true;
}

static bool set_priority(const injector_options_t *options)
{
    return (options->cpu < 0 || realtime_pin(options->cpu) == 0) &&
           (options->priority == 0 || realtime_fifo(options->priority) == 0);
}

static void print_counters(const injector_t *injector)
{
    static const char *const NAMES[INJECT_VERDICTS] = {
        "obeyed",  "damaged",     "repeated",   "stale", "out_of_range",
        "unarmed", "wrong_token", "incomplete", "busy",  "forged",
    };
    printf("{\"edges\": %u, \"failed_edges\": %u, \"dropped_frames\": %u, \"lost_commands\": %u",
           injector->edges, injector->failed_edges, injector->guard.dropped_frames,
           injector->guard.lost_commands);
    for (int i = 0; i < INJECT_VERDICTS; ++i) {
        printf(", \"%s\": %u", NAMES[i], injector->guard.verdicts[i]);
    }
    puts("}");
}

/* The socket, or -1 after a line that says what to do. */
static int open_can(const char *interface)
{
    int fd = can_socket_open(interface, INJECT_ID_COMMAND);
    int error = fd < 0 ? -fd : 0;
    if (error == 0 && can_socket_is_up(interface) == 0) {
        error = ENETDOWN;
    }
    if (error != 0) {
        can_socket_explain(interface, error);
    }
    return error == 0 ? fd : -1;
}

static bool begin_guard(inject_guard_t *guard, const injector_options_t *options)
{
    uint8_t key[INJECT_KEY_BYTES];
    inject_guard_begin(guard, injector_entropy(), options->line_count);
    if (options->key_path == NULL) {
        return true;
    }
    if (!injector_key_read(options->key_path, key)) {
        return false;
    }
    inject_guard_set_key(guard, key);
    return true;
}

static int serve(injector_t *injector, const injector_options_t *options)
{
    if (!begin_guard(&injector->guard, options)) {
        return INJECTOR_EXIT_USAGE;
    }
    injector->can_fd = open_can(options->interface);
    if (injector->can_fd < 0 || !open_lines(injector, options) || !set_priority(options)) {
        return INJECTOR_EXIT_USAGE;
    }
    sigset_t sleeping;
    catch_signals(&sleeping);
    puts("ready");
    (void)fflush(stdout);
    bool is_served = injector_serve(injector, &is_ending, &sleeping);
    print_counters(injector);
    return is_served ? EXIT_SUCCESS : EXIT_FAILURE;
}

int main(int argc, char **argv)
{
    static injector_t  injector;
    injector_options_t options;
    say_as("skiplatch-injector");
    if (!injector_options_parse(&options, argc, argv)) {
        return INJECTOR_EXIT_USAGE;
    }
    if (options.has_help) {
        injector_options_print_help();
        return EXIT_SUCCESS;
    }
    return serve(&injector, &options);
}
