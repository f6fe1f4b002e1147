/*
 * The two pulse inputs (hal_pulse.h): two lines of a GPIO chip, by libgpiod v2, with the kernel's
 * stamps. The kernel keeps up to 1024 pulses until they are taken, then drops the oldest, and
 * numbers all, so that the next one tells of the gap. Pulses of a line that come faster than its
 * interrupt thread runs it merges into one, unseen.
 */
#ifndef LINUX_PULSE_H
#define LINUX_PULSE_H

#include <stdint.h>

#include "hal_pulse.h"

#define PULSE_HELD 1024u

typedef struct {
    const char *chip; /* path, name below /dev, or label; outlives the use */
    uint32_t    offsets[HAL_PULSE_CHANNELS];
    const char *consumer; /* what the kernel tells others who has the lines */
} pulse_lines_t;

/*
 * From now on hal_pulse_start() asks for these lines. Tries them: 0, or an errno after a line that
 * says what to do.
 */
int pulse_open(const pulse_lines_t *lines);

/* To be polled for reading; negative while nothing is watched or after pulse_error(). */
int pulse_fd(void);

/* What went wrong with a reading since the start, as an errno: the chip has gone. 0: nothing. */
int pulse_error(void);

#endif
