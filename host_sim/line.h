/*
 * Input stage: the trigger line from the contact at the connector to the pin behind the input
 * filter. The pin follows the contact once that has rested for the filter's time (step 3 of the
 * nominal chain); a pulse shorter than the filter never reaches it.
 */
#ifndef SIM_LINE_H
#define SIM_LINE_H

#include <stdbool.h>

#include "sim_time.h"

typedef struct {
    sim_ns_t filter;
    sim_ns_t contact_at; /* next change of the contact, or SIM_NEVER */
    sim_ns_t pin_at;     /* next change of the pin, or SIM_NEVER */
    bool     contact;    /* true: deflected */
    bool     pin;
} sim_line_t;

/* Open contact, nothing on its way. */
void sim_line_reset(sim_line_t *line, sim_ns_t filter);

/* Plan the next change of the contact, in place of the one planned before; SIM_NEVER for none. */
void sim_line_plan(sim_line_t *line, sim_ns_t contact_at);

/* The contact changes now. */
void sim_line_toggle_contact(sim_line_t *line);

/* The pin changes now. */
void sim_line_toggle_pin(sim_line_t *line);

#endif
