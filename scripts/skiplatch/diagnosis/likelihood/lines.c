#include "diagnosis/likelihood/lines.h"

#include <math.h>

#include "diagnosis/density/residual.h"
#include "diagnosis/likelihood/numbers.h"
#include "diagnosis/likelihood/touch_law.h"

#define OFF_GRID 1e-3 /* share of values that may lie off a coarse grid */
#define MOSTLY   0.5  /* share from which on values that keep no grid say that there is none */
#define FAR_OFF  0.01 /* of the mean density of a law, beyond which a value is none of it */

/* Values, and the lines that they may lie on. */
typedef struct {
    const double *values;  /* of all touches; NaN if not known */
    sim_number_t  line;    /* where one of them is; 0 for all where the believed grid has it, too */
    double        coarse;  /* distance of the lines */
    double        fine;    /* what values are rounded to */
    bool          is_down; /* they are rounded down; else perhaps to the nearest */
    double        gridless; /* what speaks against each if they say that they keep no lines */
} lines_t;

/* How many of some values lie on lines. */
typedef struct {
    uint64_t known;
    uint64_t nearest; /* rounded to the nearest */
    uint64_t down;    /* rounded down */
    bool     is_told; /* by the values, where the lines are */
} kept_t;

/*
 * The likeliest share of values that keep no grid, if so many are off lines so wide. All of them,
 * unless most are on its lines: some grid of so many holds a few by accident.
 */
static double share_anywhere(double share_off, double period, double width)
{
    double share = fmax(share_off * period / (period - width), OFF_GRID);
    return share < MOSTLY ? share : 1.0;
}

static double off_line(const lines_t *lines, uint64_t i)
{
    return folded(lines->values[i] - number_at(lines->line, i), lines->coarse) / lines->fine;
}

static bool is_nearest(double off)
{
    return fabs(off) < 0.5;
}

/* Lines are known to a hair, so that values may be off by it at either end; a wider window holds no
 * other value if lines are far apart. */
static bool is_down(const lines_t *lines, double off)
{
    bool are_apart = lines->coarse >= (double)SIM_LINES_APART * lines->fine;
    return off > (are_apart ? -1.0 - ROUNDING : ROUNDING - 1.0) && off < ROUNDING;
}

static kept_t count_kept(const lines_t *lines, const sim_member_t *member)
{
    kept_t kept = {0};
    for (uint64_t k = 0; k < member->count; ++k) {
        uint64_t i = member->rows[k];
        double   off = off_line(lines, i);
        kept.is_told = kept.is_told || !(fabs(number_at(lines->line, i)) <= 0.0);
        kept.known += isnan(lines->values[i]) ? 0u : 1u;
        kept.nearest += is_nearest(off) ? 1u : 0u;
        kept.down += is_down(lines, off) ? 1u : 0u;
    }
    return kept;
}

/*
 * Weigh values by whether they lie on lines.
 *
 * Of lines that are told by the touches, these decide as well how many keep them at all: steps of
 * more than one size do not, nor do those of another surface than the one recorded.
 */
static void weigh_by_lines(const lines_t *lines, const sim_member_t *member, double *bonus)
{
    kept_t   kept = count_kept(lines, member);
    bool     to_nearest = !lines->is_down && kept.nearest >= kept.down;
    uint64_t on = to_nearest ? kept.nearest : kept.down;
    double   anywhere = OFF_GRID;
    if (kept.is_told) {
        double share_off = kept.known == 0u ? 1.0 : 1.0 - (double)on / (double)kept.known;
        anywhere = share_anywhere(share_off, lines->coarse, lines->fine);
    }
    double on_a_line = log(anywhere + (1.0 - anywhere) * lines->coarse / lines->fine);
    double off_them = log(anywhere);
    for (uint64_t k = 0; k < member->count; ++k) {
        uint64_t i = member->rows[k];
        double   off = off_line(lines, i);
        bool     is_on = to_nearest ? is_nearest(off) : is_down(lines, off);
        double   known = anywhere < 1.0 ? (is_on ? on_a_line : off_them) : lines->gridless;
        bonus[k] = isnan(lines->values[i]) ? 0.0 : known;
    }
}

/* Weigh stamps by whether they lie on coarse ticks. */
static void weigh_by_ticks(const sim_touches_t *of, const sim_member_t *member, double *bonus)
{
    const sim_change_t *change = member->change;
    bool                is_foreign = fabs(change->tick_line_us) > 0.0;
    lines_t             ticks = {
        .values = of->latch_us,
        .line = {.all = change->tick_line_us},
        .coarse = change->coarse_us,
        .fine = of->tick_us,
        .is_down = is_foreign,     /* half a tick either way is in where its ticks are */
        .gridless = log(OFF_GRID), /* a clock has one grid: these were not rounded to it */
    };
    double closest_us = (double)SIM_LINES_APART * of->stamp_step_us;
    bool   is_seen = !is_foreign || change->coarse_us >= closest_us;
    if (is_seen && ticks.coarse > ticks.fine) {
        weigh_by_lines(&ticks, member, bonus);
    }
}

/* Density of touch i so soon after the end of a slot. */
static double density_in_slot(const sim_touches_t *of, const sim_member_t *member, uint64_t i)
{
    const sim_change_t *change = member->change;
    double              later_us = number_at(change->skip_us, i) + number_at(change->stamp_us, i);
    double           since_us = of->latch_us[i] - of->behind_us - later_us - change->slot_phase_us;
    double           off_us = folded(since_us, change->slot_us);
    const sim_law_t *chain = &member->recorded->chain[i];
    double           coarser_us = fmax(0.0, change->coarse_us - of->tick_us);
    sim_law_t        sharp = {.offset = chain->offset - coarser_us,
                              .box_a = of->jitter_us,
                              .box_b = chain->box_b + coarser_us};
    sim_residuals_t  one = {.laws = &sharp, .n = 1, .extra_count = 0, .resolution = of->resolution};
    residual_part_t  part = residual_part(&one, 0, 0);
    double           density = residual_part_density(&part, off_us);
    return residual_density(density, off_us, change->slot_us);
}

/* Weigh stamps by the slots that triggers arrive in: latched so soon after the end of one. How long
 * a trigger waits for that is in the law already, wherever the slots end. */
static void weigh_by_slots(const sim_touches_t *of, const sim_member_t *member, double *bonus)
{
    double slot_us = member->change->slot_us;
    double width_us = of->jitter_us + fmax(of->tick_us, member->change->coarse_us);
    if (slot_us < 2.0 * width_us || member->count == 0u) {
        return;
    }
    uint64_t off = 0;
    for (uint64_t k = 0; k < member->count; ++k) {
        off += density_in_slot(of, member, member->rows[k]) * width_us < FAR_OFF ? 1u : 0u;
    }
    double anywhere = share_anywhere((double)off / (double)member->count, slot_us, width_us);
    for (uint64_t k = 0; k < member->count; ++k) {
        double density = density_in_slot(of, member, member->rows[k]);
        bonus[k] += log(anywhere + (1.0 - anywhere) * slot_us * density);
    }
}

void sim_line_bonus(const sim_touches_t *of, const sim_member_t *member, double *bonus)
{
    const sim_change_t *change = member->change;
    for (uint64_t k = 0; k < member->count; ++k) {
        bonus[k] = 0.0;
    }
    if (member->stream == SIM_LATCH_SKIP || member->stream == SIM_LATCH_PLC) {
        weigh_by_ticks(of, member, bonus);
    }
    if (member->stream == SIM_LATCH_SKIP) {
        weigh_by_slots(of, member, bonus);
    } else if (is_length(member->stream) && change->coarse_um > of->resolution_um) {
        lines_t steps = {.values = of->deviation_um,
                         .line = change->line_um,
                         .coarse = change->coarse_um,
                         .fine = of->resolution_um};
        weigh_by_lines(&steps, member, bonus);
    }
}
