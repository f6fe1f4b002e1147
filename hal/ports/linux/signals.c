#include "signals.h"

#include <errno.h>
#include <signal.h>
#include <sys/signalfd.h>
#include <unistd.h>

int signals_start(void)
{
    sigset_t set;
    (void)sigemptyset(&set);
    (void)sigaddset(&set, SIGINT);
    (void)sigaddset(&set, SIGTERM);
    (void)sigaddset(&set, SIGUSR1);
    if (sigprocmask(SIG_BLOCK, &set, NULL) != 0) {
        return -errno;
    }
    int descriptor = signalfd(-1, &set, SFD_NONBLOCK | SFD_CLOEXEC);
    return descriptor < 0 ? -errno : descriptor;
}

signals_t signals_take(int descriptor)
{
    struct signalfd_siginfo info;
    signals_t               taken = {.end = false};
    while (read(descriptor, &info, sizeof info) == (ssize_t)sizeof info) {
        taken.tell = taken.tell || info.ssi_signo == SIGUSR1;
        taken.end = taken.end || info.ssi_signo != SIGUSR1;
    }
    return taken;
}
