/*
 * Calls of the system that fail when a test wants them to: the program is linked with --wrap of
 * calloc, free and pthread_create. They are counted from the last reset or fail on.
 */
#ifndef SUPPORT_FAILING_CALLS_H
#define SUPPORT_FAILING_CALLS_H

#include <stdint.h>

typedef enum { FAILING_CALLOC, FAILING_THREAD, FAILING_KINDS } failing_call_t;

/* None fails. What is held is forgotten. */
void failing_calls_reset(void);

/* Count anew; calls number first … last of that kind fail, counted from 1, and of no other. */
void failing_calls_fail(failing_call_t kind, uint32_t first, uint32_t last);

/* How many were made of that kind, those that failed among them. */
uint32_t failing_calls_made(failing_call_t kind);

/* How many allocations have not been freed. */
uint32_t failing_calls_held(void);

#endif
