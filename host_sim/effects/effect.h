/*
 * What an effect is. An effect changes one quantity of the chain: it is handed the value that the
 * chain has so far and returns the value it makes of it. One with the parameter SIM_MOVES_SURFACE,
 * if that is on, moves the surface in place of its quantity: it is met later, and farther on. Add
 * one: write the function in the file of its stage (or in a file of its own), declare it below, and
 * give it a row in table.c.
 */
#ifndef EFFECTS_EFFECT_H
#define EFFECTS_EFFECT_H

#include <stdint.h>

#include "chain.h"
#include "effects/description.h"
#include "random.h"

/* The quantities, and when the chain asks for them. */
typedef enum {
    SIM_FEED,          /* mm/min, at the start of each motion */
    SIM_ACCEL,         /* mm/s², at the start of each touch */
    SIM_SURFACE,       /* µm by which the surface lies farther, at the start of each approach */
    SIM_PRETRAVEL,     /* µm, at the start of each approach; machine only, as the next two */
    SIM_PROBE_DELAY,   /* µs, at the start of each touch */
    SIM_LINK,          /* µs, master clock: when a trigger sent at the value arrives */
    SIM_FILTER,        /* µs, at the start of each touch */
    SIM_CONTACT,       /* µs from the closing of the contact until it counts; infinite: never */
    SIM_INTERRUPT,     /* µs from the pin to the edge interrupt */
    SIM_CAPTURE,       /* µs, device clock: the time stamp captured at an edge */
    SIM_CLOCK,         /* µs, device clock at the master clock's value */
    SIM_SCAN_PERIOD,   /* µs, once */
    SIM_SCAN_START,    /* µs by which one scan begins late; see sim_effects_most_us */
    SIM_SCAN_PHASE,    /* 0 … 1: where in a scan period the pin changes */
    SIM_IMAGE_DELAY,   /* scans, once */
    SIM_POSITION_TIME, /* µs, device clock: the time of which the position is read */
    SIM_POSITION,      /* µm past the surface */
    SIM_READING,       /* the same, as an encoder with lines of its own reads it */
    SIM_REPORT         /* µs of travel of a report */
} sim_quantity_t;

#define SIM_MOVES_SURFACE "moves_surface"

enum { SIM_STATES = 4 };

/* What an effect can look at. */
typedef struct {
    const sim_chain_t *chain;
    const sim_touch_t *touch;      /* the present one; NULL for what is asked once */
    const double      *parameters; /* in the order of the table's row */
    double            *state;      /* SIM_STATES numbers, 0 at first, kept from touch to touch */
    sim_random_t      *random;     /* of this effect and touch; of this effect and scan for scans */
    double             rig;        /* uniform in [0, 1), fixed while the rig is switched on */
    double             now_us;     /* master clock */
    double             scan_us;    /* from one scan to the next, once the rig is switched on */
    double             speed_um_us; /* of the axis now, along the approach */
} sim_effect_call_t;

/* Where a grid of the rig begins, as a share of its period; 0: anywhere, the same all the while. */
static inline double effect_origin(const sim_effect_call_t *call, double share)
{
    return share > 0.0 ? share : call->rig;
}

typedef double sim_effect_change_t(const sim_effect_call_t *call, double value);

typedef struct {
    sim_description_t    about;
    sim_quantity_t       quantity;
    sim_effect_change_t *change;
} sim_effect_t;

/* Probe, input and latch: a delay that is longer than believed. */
sim_effect_change_t effect_delay;
/* Motion. */
sim_effect_change_t effect_feed_error;
sim_effect_change_t effect_unfinished_acceleration;
/* Probe. */
sim_effect_change_t effect_pretravel_lobing;
/* Link. */
sim_effect_change_t effect_link_slotting;
sim_effect_change_t effect_link_retry;
/* Input. */
sim_effect_change_t effect_contact_bounce;
sim_effect_change_t effect_lost_trigger;
/* Latch. */
sim_effect_change_t effect_isr_blocking;
sim_effect_change_t effect_timer_quantisation;
sim_effect_change_t effect_timer_drift;
/* Scan. */
sim_effect_change_t effect_scan_period;
sim_effect_change_t effect_scan_jitter;
sim_effect_change_t effect_scan_overrun;
sim_effect_change_t effect_input_image_delay;
sim_effect_change_t effect_scan_phase_lock;
/* Position. */
sim_effect_change_t effect_servo_hold;
sim_effect_change_t effect_following_error;
sim_effect_change_t effect_backlash;
sim_effect_change_t effect_transmission_error;
sim_effect_change_t effect_scale_error;
sim_effect_change_t effect_encoder_quantisation;
sim_effect_change_t effect_thermal_drift;
sim_effect_change_t effect_rotary_pivot;
/* Report. */
sim_effect_change_t effect_report_delay;

#endif
