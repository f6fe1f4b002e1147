#include "line.h"

void sim_line_reset(sim_line_t *line, sim_ns_t filter)
{
    *line = (sim_line_t){.filter = filter, .contact_at = SIM_NEVER, .pin_at = SIM_NEVER};
}

void sim_line_plan(sim_line_t *line, sim_ns_t contact_at)
{
    line->contact_at = contact_at;
}

void sim_line_toggle_contact(sim_line_t *line)
{
    sim_ns_t now = line->contact_at;
    line->contact = !line->contact;
    line->contact_at = SIM_NEVER;
    line->pin_at = line->contact != line->pin ? now + line->filter : SIM_NEVER;
}

void sim_line_toggle_pin(sim_line_t *line)
{
    line->pin = !line->pin;
    line->pin_at = SIM_NEVER;
}
