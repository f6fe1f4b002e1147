#include "failing_calls.h"

#include <errno.h>
#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>

/* What the linker calls them by --wrap. */
void *wrapped_calloc(size_t count, size_t bytes) __asm__("__wrap_calloc");
void  wrapped_free(void *memory) __asm__("__wrap_free");
int   wrapped_create(pthread_t *thread, const pthread_attr_t *attributes, void *(*body)(void *),
                     void *argument) __asm__("__wrap_pthread_create");
void *real_calloc(size_t count, size_t bytes) __asm__("__real_calloc");
void  real_free(void *memory) __asm__("__real_free");
int   real_create(pthread_t *thread, const pthread_attr_t *attributes, void *(*body)(void *),
                  void *argument) __asm__("__real_pthread_create");

static failing_call_t failing;
static uint32_t       first_failing;
static uint32_t       last_failing;
static uint32_t       made[FAILING_KINDS];
static uint32_t       held;

void failing_calls_reset(void)
{
    failing_calls_fail(FAILING_CALLOC, UINT32_MAX, UINT32_MAX);
    held = 0u;
}

void failing_calls_fail(failing_call_t kind, uint32_t first, uint32_t last)
{
    failing = kind;
    first_failing = first;
    last_failing = last;
    for (uint32_t i = 0u; i < FAILING_KINDS; ++i) {
        made[i] = 0u;
    }
}

uint32_t failing_calls_made(failing_call_t kind)
{
    return made[kind];
}

uint32_t failing_calls_held(void)
{
    return held;
}

static bool fails(failing_call_t kind)
{
    ++made[kind];
    return kind == failing && made[kind] >= first_failing && made[kind] <= last_failing;
}

void *wrapped_calloc(size_t count, size_t bytes)
{
    void *memory = fails(FAILING_CALLOC) ? NULL : real_calloc(count, bytes);
    held += memory != NULL;
    return memory;
}

void wrapped_free(void *memory)
{
    held -= memory != NULL;
    real_free(memory);
}

int wrapped_create(pthread_t *thread, const pthread_attr_t *attributes, void *(*body)(void *),
                   void *argument)
{
    return fails(FAILING_THREAD) ? EAGAIN : real_create(thread, attributes, body, argument);
}
