#include "simavr_rig_interrupts.h"

#include <inttypes.h>
#include <simavr/sim_interrupts.h>
#include <stdio.h>

#define RETI_CYCLES  4u /* simavr tells the end before it counts them */
#define VECTORS      64u
#define NESTING      16u
#define PIN_CHANGE   3u
#define PIN_CHANGE_C 4u
#define CAPTURE      10u
#define X1000        1000u

typedef struct {
    uint64_t calls;
    uint64_t sum;
    uint64_t least;
    uint64_t most;
} figures_t;

typedef struct {
    uint64_t begin;
    uint64_t inside; /* cycles of interrupts that ran inside this one */
} running_t;

static avr_t    *avr;
static bool      is_edge_open; /* no interrupt has taken it yet */
static uint64_t  edge_cycle;
static figures_t bodies[VECTORS];
static figures_t waits[VECTORS];
static running_t running[NESTING];
static unsigned  depth;
static uint64_t  busy;

/* ---- figures ---- */

static void add(figures_t *figures, uint64_t cycles)
{
    if (figures->calls == 0u || cycles < figures->least) {
        figures->least = cycles;
    }
    if (cycles > figures->most) {
        figures->most = cycles;
    }
    figures->sum += cycles;
    ++figures->calls;
}

static void print_figures(const char *name, const figures_t *all)
{
    for (unsigned vector = 0u; vector < VECTORS; ++vector) {
        const figures_t *f = &all[vector];
        if (f->calls != 0u) {
            printf("%s %u %" PRIu64 " %" PRIu64 " %" PRIu64 " %" PRIu64 "\n", name, vector,
                   f->calls, f->least, f->sum * X1000 / f->calls, f->most);
        }
    }
}

void interrupts_print(void)
{
    print_figures("body", bodies);
    print_figures("wait", waits);
}

/* ---- what the chip does ---- */

static void begin_interrupt(unsigned vector)
{
    if (is_edge_open && (vector == CAPTURE || vector == PIN_CHANGE || vector == PIN_CHANGE_C)) {
        add(&waits[vector], avr->cycle - edge_cycle);
        is_edge_open = false;
    }
    if (depth < NESTING) {
        running[depth] = (running_t){.begin = avr->cycle};
    }
    ++depth;
}

static void end_interrupt(unsigned vector)
{
    if (depth == 0u || --depth >= NESTING) {
        return;
    }
    uint64_t whole = avr->cycle + RETI_CYCLES - running[depth].begin;
    add(&bodies[vector], whole - running[depth].inside);
    busy += whole - running[depth].inside;
    if (depth != 0u) {
        running[depth - 1u].inside += whole;
    }
}

static void on_interrupt(avr_irq_t *irq, uint32_t value, void *param)
{
    (void)irq;
    unsigned vector = (unsigned)(uintptr_t)param;
    if (value != 0u) {
        begin_interrupt(vector);
    } else {
        end_interrupt(vector);
    }
}

void interrupts_listen(avr_t *of)
{
    avr = of;
    for (unsigned vector = 1u; vector < VECTORS; ++vector) {
        avr_irq_t *irq = avr_get_interrupt_irq(avr, (uint8_t)vector);
        if (irq != NULL) {
            avr_irq_register_notify(irq + AVR_INT_IRQ_RUNNING, on_interrupt,
                                    (void *)(uintptr_t)vector);
        }
    }
}

void interrupts_await_edge(void)
{
    edge_cycle = avr->cycle;
    is_edge_open = true;
}

bool interrupts_are_running(void)
{
    return depth != 0u;
}

uint64_t interrupts_busy_cycles(void)
{
    return busy;
}
