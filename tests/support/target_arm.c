/* A suite on a Cortex-M in its emulator: report and end by semihosting. */
#include "target.h"

#include <stdint.h>

#include "unity.h"

#define SYS_WRITEC        0x03u
#define SYS_EXIT_EXTENDED 0x20u
#define STOPPED_BY_ITSELF 0x20026u
#define SEMIHOSTING_CALL  "bkpt 0xAB"

uint32_t target_ask_host(uint32_t operation, const void *argument)
{
    register uint32_t    r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;
    __asm__ volatile(SEMIHOSTING_CALL : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

void target_put_char(char character)
{
    (void)target_ask_host(SYS_WRITEC, &character);
}

void target_done(void)
{
    const uint32_t reason[] = {STOPPED_BY_ITSELF, Unity.TestFailures != 0u ? 1u : 0u};
    (void)target_ask_host(SYS_EXIT_EXTENDED, reason);
    for (;;) {
    }
}
