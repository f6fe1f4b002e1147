#include "diagnosis/likelihood/stream_law.h"

#include <math.h>
#include <stdlib.h>

#include "diagnosis/density/residual.h"
#include "diagnosis/likelihood/numbers.h"
#include "diagnosis/likelihood/scan_grid.h"
#include "diagnosis/likelihood/touch_law.h"

#define TINY 1e-9 /* of the size of a shift, below which it is none */

/* What a slack does to one touch of a stream: its mean, and variance about that. */
typedef struct {
    double mean;
    double variance;
} told_t;

/* Room for the law of one touch with its extras. */
typedef struct {
    sim_extra_t     *extras;
    residual_part_t *parts;
} room_t;

/* A change without what moves the stamp, and so what is counted from it by as much. */
static sim_change_t timeless(const sim_change_t *change)
{
    sim_change_t found = *change;
    found.contact_us = (sim_number_t){0};
    found.surface_um = (sim_number_t){0};
    found.stamp_us = (sim_number_t){0};
    found.speed_ratio = (sim_number_t){.all = 1.0};
    return found;
}

/* Scatter that comes with a shift, if that is one, by its size over all touches. */
static double loose(const sim_member_t *member, double shift, double size)
{
    return fabs(shift) > TINY * size ? member->change->slack * size : 0.0;
}

static double size_of(double squares, uint64_t count)
{
    return count == 0u ? 0.0 : sqrt(squares / (double)count);
}

/* Widen the laws of a stream that tells of all its shift itself. */
static void loosen(const sim_member_t *member, sim_law_t *laws)
{
    const double *believed = member->recorded->believed;
    double        squares = 0.0;
    for (uint64_t k = 0; k < member->count; ++k) {
        squares += square(laws[k].offset - believed[member->rows[k]]);
    }
    double size = size_of(squares, member->count);
    for (uint64_t k = 0; k < member->count; ++k) {
        double shift = laws[k].offset - believed[member->rows[k]];
        laws[k].sigma = hypot(laws[k].sigma, loose(member, shift, size));
    }
}

/* Mean and variance of the law of touch i in a stream. */
static moments_t moments_of(const sim_touches_t *of, uint32_t stream, const sim_law_t *chain,
                            const sim_change_t *change, uint64_t i, room_t room)
{
    sim_law_t law = touch_law(of, stream, chain, change, i);
    uint32_t  count = change->extra_counts[stream];
    for (uint32_t k = 0; k < count; ++k) {
        room.extras[k] = touch_extra(of, stream, change, k, i);
    }
    sim_residuals_t one = {.laws = &law,
                           .extras = room.extras,
                           .n = 1,
                           .extra_count = count,
                           .resolution = of->resolution};
    return residual_law_moments(&one, 0, room.parts);
}

/* What the latch of touch i tells of a normal slack. */
static told_t told_by_latch(const sim_touches_t *of, const sim_member_t *member, double slack_us,
                            uint64_t i, room_t room)
{
    told_t told = {.mean = 0.0, .variance = square(slack_us)};
    for (uint32_t path = 0; path < 2u; ++path) {
        const sim_recorded_t *latch = member->latches[path];
        if (slack_us > 0.0 && latch != NULL && latch->known[i] != 0u) {
            uint32_t  stream = path == 0u ? SIM_LATCH_SKIP : SIM_LATCH_PLC;
            moments_t law = moments_of(of, stream, &latch->chain[i], member->change, i, room);
            double    both = law.variance + square(slack_us);
            double    off = limited(latch->residuals[i] - law.mean, CALM * sqrt(both));
            told.mean = square(slack_us) / both * off;
            told.variance = square(slack_us) * law.variance / both;
        }
    }
    return told;
}

/* By how much a law is off, in parts. */
typedef struct {
    double late_us; /* for the stamp is, by what the latch tells as well */
    double own;     /* for another reason */
} shift_t;

static shift_t shift_of(const sim_touches_t *of, const sim_member_t *member,
                        const sim_change_t *still, double per_us, const sim_law_t *laws, uint64_t k)
{
    uint64_t i = member->rows[k];
    double   own = touch_law(of, member->stream, &member->recorded->chain[i], still, i).offset;
    return (shift_t){.late_us = (laws[k].offset - own) / per_us,
                     .own = own - member->recorded->believed[i]};
}

/* By how much a µs of the stamp shifts touch k of a member. */
static double per_us_of(const sim_touches_t *of, const sim_member_t *member, uint64_t k)
{
    return is_beyond_stamp(member->stream) ? of->speed[member->rows[k]] : 1.0;
}

/* Widen the laws of a stream that is counted from the stamp, by what the latch leaves open. */
static void loosen_after_latch(const sim_touches_t *of, const sim_member_t *member, room_t room,
                               sim_law_t *laws)
{
    sim_change_t still = timeless(member->change);
    shift_t      squares = {0};
    for (uint64_t k = 0; k < member->count; ++k) {
        shift_t shift = shift_of(of, member, &still, per_us_of(of, member, k), laws, k);
        squares.late_us += square(shift.late_us);
        squares.own += square(shift.own);
    }
    double late_size = size_of(squares.late_us, member->count);
    double own_size = size_of(squares.own, member->count);
    for (uint64_t k = 0; k < member->count; ++k) {
        double  per_us = per_us_of(of, member, k);
        shift_t shift = shift_of(of, member, &still, per_us, laws, k);
        double  slack_us = loose(member, shift.late_us, late_size);
        double  own = loose(member, shift.own, own_size);
        told_t  told = told_by_latch(of, member, slack_us, member->rows[k], room);
        laws[k].offset -= per_us * told.mean;
        laws[k].sigma = sqrt(square(laws[k].sigma) + square(own) + square(per_us) * told.variance);
    }
}

static uint32_t most_extras(const sim_change_t *change)
{
    uint32_t most = 0u;
    for (uint32_t stream = 0u; stream < SIM_STREAM_COUNT; ++stream) {
        uint32_t count = change->extra_counts[stream];
        most = count > most ? count : most;
    }
    return most;
}

/* Write the laws of a member without what slack and widening make of them. */
static void write_laws(const sim_touches_t *of, const sim_member_t *member, sim_law_t *laws)
{
    bool is_grid = member->stream == SIM_LATTICE && member->count > 0u;
    if (is_grid) {
        laws[0] = grid_law(of, member);
    }
    for (uint64_t k = is_grid ? 1u : 0u; k < member->count; ++k) {
        const sim_law_t *chain = &member->recorded->chain[member->rows[k]];
        laws[k] = is_grid ? laws[0]
                          : touch_law(of, member->stream, chain, member->change, member->rows[k]);
    }
}

int sim_stream_laws(const sim_touches_t *of, const sim_member_t *member, uint64_t stride,
                    sim_law_t *laws, sim_extra_t *extras)
{
    const sim_change_t *change = member->change;
    write_laws(of, member, laws);
    for (uint32_t e = 0; e < change->extra_counts[member->stream]; ++e) {
        for (uint64_t k = 0; k < member->count; ++k) {
            extras[e * stride + k] = touch_extra(of, member->stream, change, e, member->rows[k]);
        }
    }
    bool is_room = true;
    if (change->slack > 0.0 && is_after_latch(member->stream)) {
        uint32_t most = most_extras(change);
        room_t   room = {.extras = calloc(most + (size_t)1, sizeof *room.extras),
                         .parts = calloc(most + (size_t)1, sizeof *room.parts)};
        is_room = room.extras != NULL && room.parts != NULL;
        if (is_room) {
            loosen_after_latch(of, member, room, laws);
        }
        free(room.extras);
        free(room.parts);
    } else if (change->slack > 0.0 && member->stream != SIM_LATTICE) {
        loosen(member, laws);
    }
    for (uint64_t k = 0; k < member->count && member->widening > 0.0; ++k) {
        laws[k].sigma = hypot(laws[k].sigma, member->widening);
    }
    return is_room ? 0 : -1;
}
