/*
 * A recorded file of pulses as docs/TRANSMISSION.md has it, in order of time: pulses of two lines
 * may come in another order than their stamps, so the last few are held back.
 */
#ifndef LINUX_PULSE_FILE_H
#define LINUX_PULSE_FILE_H

#include <stdint.h>
#include <stdio.h>

#define PULSE_FILE_HELD 32u

typedef struct {
    FILE    *file;
    uint64_t count;                  /* written */
    uint64_t words[PULSE_FILE_HELD]; /* as in the file, the earliest first */
    unsigned held;
} pulse_file_t;

/* Begin a file. 0 or an errno. */
int pulse_file_open(pulse_file_t *pulses, const char *path);

/* Add a pulse of channel 0 or 1, in nanoseconds below 2^61. 0 or an errno: the disk may be full. */
int pulse_file_add(pulse_file_t *pulses, uint8_t channel, uint64_t t_ns);

/* Write what is held back, and the number of pulses into the head. 0 or an errno. */
int pulse_file_close(pulse_file_t *pulses);

#endif
