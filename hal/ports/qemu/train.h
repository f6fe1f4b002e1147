/*
 * A second program for boards whose emulator cannot be told when edges shall come one after
 * another: their wiring, and edges that it makes itself. It makes them in the interrupt of the
 * scans, which then comes every TRAIN_SPACING_US; one in so many is a scan. A board's main_train.c
 * drives the line.
 *
 * A rig writes in memory how long a train shall be, and reads there what came of it.
 */
#ifndef QEMU_TRAIN_H
#define QEMU_TRAIN_H

#include <stdbool.h>

#define TRAIN_SPACING_US 20u

/* The wiring, and that is all until a rig asks for a train; ends only if it cannot start. Task. */
int train_main(void);

/* True if the line shall rise now. Interrupt, each time board_on_scan() comes. */
bool train_edge_is_due(void);

/* A scan, if it is time for one. Interrupt, each time board_on_scan() comes, after the edge. */
void train_scan(void);

#endif
