/*
 * Core 1: how core 0 starts it, and the two mailboxes between them (the chip's FIFOs of eight
 * words). Each core has interrupts, and a mask for them, of its own.
 */
#ifndef RP2040_CORE1_H
#define RP2040_CORE1_H

#include <stdbool.h>
#include <stdint.h>

/*
 * Start core 1, which waits in its ROM since reset, at `entry`, which does not return. It has the
 * vectors of core 0 and a stack of 1 KiB. Core 0, once.
 */
void core1_start(void (*entry)(void));

/* To the other core; false, and nothing happens, while eight words are on their way. Task. */
bool mailbox_put(uint32_t word);

/* The same, waiting for room. Task. */
void mailbox_send(uint32_t word);

/* Take the other core's next word; false, and nothing happens, if there is none. Task. */
bool mailbox_take(uint32_t *word);

/* The same, waiting for it. Task. */
uint32_t mailbox_wait(void);

#endif
