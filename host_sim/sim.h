/*
 * The simulated rig: one more port of the firmware, on virtual time. Event driven: time jumps to
 * the next thing that happens. The stages of the chain are modules of their own (axis, probe, line,
 * scan, bus); this one joins them and is what the HAL of port.c reads.
 *
 * Stimulus → pin → interrupt or scan: sim_advance() carries that out and tells the wiring what
 * happened; the wiring then runs the firmware's task.
 */
#ifndef SIM_SIM_H
#define SIM_SIM_H

#include <stdbool.h>
#include <stdint.h>

#include "axis.h"
#include "bus.h"
#include "chain.h"
#include "effects/active.h"
#include "line.h"
#include "random.h"
#include "scan.h"
#include "seat.h"
#include "sim_time.h"

typedef enum {
    SIM_EVENT_NONE,  /* nothing is left to happen */
    SIM_EVENT_LEVEL, /* the pin changed */
    SIM_EVENT_EDGE,  /* the edge interrupt ran */
    SIM_EVENT_SCAN,  /* a PLC scan is due */
    SIM_EVENT_AXIS,  /* the axis came to rest */
    SIM_EVENT_WAKE,  /* the time set by sim_wake_after() is over */
    SIM_EVENT_FRAME  /* frames arrived at the recorder */
} sim_event_t;

typedef struct {
    const sim_chain_t *chain;
    const sim_touch_t *touch; /* the present one */
    sim_ns_t           now;
    sim_ns_t           axis_at; /* standstill, SIM_NEVER while at rest */
    sim_ns_t           edge_at; /* edge interrupt, SIM_NEVER when none is due */
    sim_ns_t           wake_at;
    sim_ns_t           delay;        /* mechanical trigger to contact */
    sim_ns_t           triggered_at; /* when the probe triggers in this approach */
    sim_ns_t           closed_at;    /* when the contact first closed in this approach */
    double             pretravel_um; /* of the present approach */
    sim_rest_t         rest;         /* where the tip rests before it */
    uint64_t           seed;
    uint64_t           replicate;
    double             filter_us;   /* the filter of the set-up */
    double             count_um;    /* what a count of the position is */
    double             off_line_um; /* the datum, past a line of the counter */
    sim_ns_t           ticks_time;  /* the last time turned into ticks, and the ticks it is */
    uint64_t           ticks;
    uint32_t           tick_ps;
    double             start_spread_us; /* by up to which moves of the PLC path begin later */
    sim_ns_t           start_delay;     /* by which the present one does */
    bool               is_edge_armed;
    sim_random_t       random;
    sim_axis_t         axis;
    sim_line_t         line;
    sim_scan_t         scan;
    sim_bus_t          bus;
    sim_ns_t           captured_later; /* while an edge is captured: its stamp, less its time */
    bool               is_scanning;    /* what the clock shows goes into the stamp of a scan */
    sim_effects_t      effects;
} sim_t;

/*
 * Switch the rig on at `now`, with effects as for sim_effects_boot(). `chain` and `settings` have
 * to outlive it, and `sim` has to stay where it is.
 */
void sim_boot(sim_t *sim, const sim_chain_t *chain, const sim_setting_t *settings, uint32_t count,
              uint64_t seed, uint64_t replicate, sim_ns_t now);

/* What the effects make of a quantity of the chain. */
double sim_change(sim_t *sim, sim_quantity_t quantity, double value);

/*
 * Jump to the start of a touch: axis at rest at the stand-off, contact open. `touch` has to
 * outlive it.
 */
void sim_begin_touch(sim_t *sim, const sim_touch_t *touch);

/* Jump to the next event, let it happen, and tell what it was. */
sim_event_t sim_advance(sim_t *sim);

/* Begin a motion to `target_um` past the nominal surface. */
void sim_move(sim_t *sim, double target_um, double feed_mm_min);

/* Decelerate after `reaction`. */
void sim_stop(sim_t *sim, sim_ns_t reaction);

bool sim_is_moving(const sim_t *sim);

/* A position as a counter tells it, SIM_COUNTS_MAX either way at most. */
int32_t sim_counts(const sim_t *sim, double position_um);

/* ---- the clock of the device, its stamps, and when touches begin: sim_clock.c ---- */

/* A time at which `ticks` more of the device clock are over; SIM_NEVER for UINT32_MAX. */
sim_ns_t sim_time_after(sim_t *sim, uint32_t ticks);

/* A time of the master clock, changed by effects that go by the device clock. */
sim_ns_t sim_change_time(sim_t *sim, sim_quantity_t quantity, sim_ns_t time);

/* Wake the task at that time. */
void sim_wake_after(sim_t *sim, uint32_t ticks);

/* Whether the device clock runs at half to twice its rate, in the touch that begins now. */
bool sim_clock_goes_on(sim_t *sim);

/* Device clock without the wrap. */
uint64_t sim_clock_ticks(sim_t *sim, sim_ns_t time);

/* The same now, as it gets into a stamp; and by how much `later` than a believed tick that is. */
uint64_t sim_stamp_ticks(sim_t *sim, sim_ns_t *later);

/* After sim_boot(): let scans, and moves of the PLC path, begin when the controller says. */
void sim_set_begins(sim_t *sim, const sim_controller_t *controller);

/* The time at which a touch begins. */
sim_ns_t sim_touch_start(const sim_t *sim, const sim_touch_t *touch);

#endif
