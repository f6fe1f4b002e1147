/*
 * A fake of hal_critical.h. It fails the test when sections are not closed in turn, and tells
 * whether interrupts are masked now.
 */
#ifndef SUPPORT_FAKE_CRITICAL_H
#define SUPPORT_FAKE_CRITICAL_H

#include <stdbool.h>

/* Nothing masked; `on_unmask`, unless NULL, is called whenever the outermost section has ended. */
void fake_critical_reset(void (*on_unmask)(void));

/* From now on sections are counted, but mask nothing: what a port looks like that got it wrong. */
void fake_critical_stop_masking(void);

bool fake_critical_is_masked(void);

/* Sections begun since the reset. */
unsigned fake_critical_sections(void);

/* Fail the test if a section is still open. */
void fake_critical_verify(void);

#endif
