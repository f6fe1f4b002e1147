/*
 * How a suite that runs on a board, or in its emulator, speaks and ends. One implementation a
 * family: target_FAMILY.c. Unity is compiled to use it (mk/variants.mk).
 */
#ifndef SUPPORT_TARGET_H
#define SUPPORT_TARGET_H

#include <stdint.h>

/* Print one character of the suite's report. */
void target_put_char(char character);

/* The report is complete: end the emulation with 0, or 1 if a test failed. Does not return. */
void target_done(void);

/*
 * A call of semihosting, which the families in QEMU have: what the host is asked, and the address
 * of its argument. Gives the host's answer.
 */
uint32_t target_ask_host(uint32_t operation, const void *argument);

#endif
