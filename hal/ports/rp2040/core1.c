#include "core1.h"

#include "rp2040.h"

#define STACK_WORDS 128u /* of 64 bits, as a Cortex-M wants its stack aligned */

static uint64_t stack[STACK_WORDS];

bool mailbox_put(uint32_t word)
{
    if ((SIO_FIFO_ST & FIFO_HAS_ROOM) == 0u) {
        return false;
    }
    SIO_FIFO_WR = word;
    __asm__ volatile("sev"); /* the ROM of core 1 sleeps until then */
    return true;
}

void mailbox_send(uint32_t word)
{
    while (!mailbox_put(word)) {
    }
}

bool mailbox_take(uint32_t *word)
{
    if ((SIO_FIFO_ST & FIFO_HAS_WORD) == 0u) {
        return false;
    }
    *word = SIO_FIFO_RD;
    return true;
}

uint32_t mailbox_wait(void)
{
    uint32_t word = 0u;
    while (!mailbox_take(&word)) {
    }
    return word;
}

static uint32_t address_of(const void *object)
{
    return (uint32_t)(uintptr_t)object;
}

/* The ROM takes these words in this order, sends each of them back, and begins anew at a wrong one.
 */
void core1_start(void (*entry)(void))
{
    const uint32_t words[] = {
        0u, 0u, 1u, SCB_VTOR, address_of(stack + STACK_WORDS), (uint32_t)(uintptr_t)entry};
    uint32_t taken = 0u;
    while (taken < sizeof words / sizeof *words) {
        uint32_t left_over;
        while (words[taken] == 0u && mailbox_take(&left_over)) {
        }
        mailbox_send(words[taken]);
        taken = mailbox_wait() == words[taken] ? taken + 1u : 0u;
    }
}
