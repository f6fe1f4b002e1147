/* Finding a GPIO chip by what a user calls it, and saying what is wrong with a request. */
#ifndef LINUX_CHIP_H
#define LINUX_CHIP_H

#include <gpiod.h>
#include <stdint.h>

/*
 * Open the chip called `name`: a path, a name below /dev, or a label. NULL with errno set if there
 * is none; gpiod_chip_close() closes it.
 */
struct gpiod_chip *chip_open(const char *name);

/* Say in one line why the chip cannot be had, and what to do. */
void chip_explain(const char *name, int error);

/* Say in one line why line `offset` of an open chip cannot be had, and what to do. */
void chip_explain_line(struct gpiod_chip *chip, const char *name, uint32_t offset, int error);

#endif
