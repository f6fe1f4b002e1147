#include "realtime.h"

#include <errno.h>
#include <sched.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "say.h"

int realtime_pin(int cpu)
{
    cpu_set_t set;
    CPU_ZERO(&set);
    if (cpu >= 0 && cpu < CPU_SETSIZE) {
        CPU_SET((size_t)cpu, &set);
        if (sched_setaffinity(0, sizeof set, &set) == 0) {
            return 0;
        }
    }
    int error = errno == EPERM ? EPERM : EINVAL;
    say("processor %d cannot be had: %ld are online; see: nproc, taskset -p $$", cpu,
        sysconf(_SC_NPROCESSORS_ONLN));
    return error;
}

int realtime_fifo(int priority)
{
    struct sched_param parameters = {.sched_priority = priority};
    if (sched_setscheduler(0, SCHED_FIFO, &parameters) == 0) {
        return 0;
    }
    int error = errno;
    say("no permission for SCHED_FIFO priority %d (%s); run as root, or: "
        "sudo setcap cap_sys_nice+ep PROGRAM",
        priority, strerror(error));
    return error;
}

int realtime_lock_memory(void)
{
    if (mlockall(MCL_CURRENT | MCL_FUTURE) == 0) {
        return 0;
    }
    int error = errno;
    say("memory cannot be locked (%s); run as root, or: ulimit -l unlimited", strerror(error));
    return error;
}
