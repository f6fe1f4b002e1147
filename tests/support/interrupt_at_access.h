/*
 * Interrupts code just before its n-th access to memory. The code is compiled with
 * -fsanitize=thread, which calls a hook at every access; the hooks are here, in place of the
 * sanitizer's own. While fake_critical masks interrupts, one that is due waits until it does not.
 */
#ifndef SUPPORT_INTERRUPT_AT_ACCESS_H
#define SUPPORT_INTERRUPT_AT_ACCESS_H

#include <stdbool.h>
#include <stddef.h>

#define INTERRUPTS_MAX 2u

/* Run `number` is due: what the interrupt does. Its own accesses count for nothing. */
typedef void interrupt_t(unsigned number);

/* Accesses of the code to this object have to be masked. */
void interrupt_watch(const void *object, size_t size);

/* From now on: interrupt just before the accesses `at` (`count` of them, from 0, in order). */
void interrupt_begin(interrupt_t *interrupt, const unsigned *at, unsigned count);

/* The code is over. Returns the accesses it made; an interrupt that was due later did not run. */
unsigned interrupt_end(void);

/* Interrupts that ran. */
unsigned interrupt_runs(void);

/* Accesses to the watched object since interrupt_begin() that were not masked. */
unsigned interrupt_unmasked_accesses(void);

/* To be called when the last critical section ends: runs what is due. */
void interrupt_on_unmask(void);

#endif
