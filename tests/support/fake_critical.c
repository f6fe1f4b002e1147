#include "fake_critical.h"

#include <stddef.h>

#include "hal_critical.h"
#include "unity.h"

/* The state handed out differs from any depth, so that a caller cannot make one up. */
#define STATE_OF(depth) (0xC0DE0000u + (depth))

static void (*unmasked)(void);
static unsigned depth;
static unsigned sections;
static bool     is_deaf;

void fake_critical_reset(void (*on_unmask)(void))
{
    unmasked = on_unmask;
    depth = 0u;
    sections = 0u;
    is_deaf = false;
}

void fake_critical_stop_masking(void)
{
    is_deaf = true;
}

bool fake_critical_is_masked(void)
{
    return depth > 0u && !is_deaf;
}

unsigned fake_critical_sections(void)
{
    return sections;
}

void fake_critical_verify(void)
{
    TEST_ASSERT_EQUAL_UINT_MESSAGE(0u, depth, "a critical section was left open");
}

hal_critical_state_t hal_critical_enter(void)
{
    ++sections;
    return STATE_OF(depth++);
}

void hal_critical_exit(hal_critical_state_t saved)
{
    TEST_ASSERT_TRUE_MESSAGE(depth > 0u, "a critical section was closed twice");
    TEST_ASSERT_EQUAL_HEX32_MESSAGE(STATE_OF(depth - 1u), saved, "sections not closed in turn");
    --depth;
    if (depth == 0u && unmasked != NULL) {
        unmasked();
    }
}
