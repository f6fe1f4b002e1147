/* Signals as something to be polled for, so that none comes in between. */
#ifndef LINUX_SIGNALS_H
#define LINUX_SIGNALS_H

#include <stdbool.h>

typedef struct {
    bool end;  /* SIGINT or SIGTERM came */
    bool tell; /* SIGUSR1 came */
} signals_t;

/* From now on signals wait to be taken. Returns the descriptor to poll, or a negative errno. */
int signals_start(void);

/* Take all that have come. */
signals_t signals_take(int descriptor);

#endif
