#include "diagnosis/likelihood/touch_law.h"

#include <math.h>

#include "diagnosis/density/sum.h"
#include "diagnosis/likelihood/numbers.h"

#define BOX_DEVIATION 3.4641016151377544 /* width of a box over its standard deviation */

/* What makes laws, of one touch. */
typedef struct {
    const sim_touches_t *of;
    const sim_change_t  *change;
    uint64_t             i;
    double               ratio; /* of speeds, changed over believed */
    double               speed; /* once it is changed */
    double               coarser_us;
    double               coarser_um;
} touch_t;

static touch_t touch_at(const sim_touches_t *of, const sim_change_t *change, uint64_t i)
{
    double ratio = number_at(change->speed_ratio, i);
    return (touch_t){
        .of = of,
        .change = change,
        .i = i,
        .ratio = ratio,
        .speed = of->speed[i] * ratio,
        .coarser_us = fmax(0.0, change->coarse_us - of->tick_us),
        .coarser_um = fmax(0.0, change->coarse_um - of->resolution_um),
    };
}

/* Pretravel once it is changed. */
static double pretravel_um(const touch_t *touch)
{
    double known = touch->of->pretravel_um[touch->i];
    double changed = known + number_at(touch->change->pretravel_um, touch->i);
    return fmax(touch->of->least_pretravel_um, changed);
}

/* By how much the contact comes later. */
static double contact_us(const touch_t *touch)
{
    double farther_um = number_at(touch->change->surface_um, touch->i);
    return number_at(touch->change->contact_us, touch->i) + farther_um / touch->speed;
}

/* What is added to the position. */
static double position_um(const touch_t *touch)
{
    double older_us = number_at(touch->change->position_us, touch->i);
    return number_at(touch->change->position_um, touch->i) + touch->speed * older_us;
}

static double position_sigma_um(const touch_t *touch)
{
    return touch->speed * number_at(touch->change->position_sigma_us, touch->i);
}

/* By how much the pin changes later, counted from what the latch is counted from. */
static double mechanics_us(const touch_t *touch)
{
    double later = number_at(touch->change->pin_us, touch->i);
    if (touch->of->is_machine != 0u) {
        double sooner = touch->of->pretravel_um[touch->i] / touch->of->speed[touch->i];
        later += contact_us(touch);
        later += pretravel_um(touch) / touch->speed - sooner;
    }
    return later;
}

/* The delay behind the pin, on the path of the stream. */
static double path_us(const touch_t *touch, uint32_t stream)
{
    const sim_change_t *change = touch->change;
    return number_at(is_polled(stream) ? change->plc_us : change->skip_us, touch->i);
}

/* The box of the wait for the scan; `scale` turns µs into the law's unit. */
static double wait_box(const touch_t *touch, uint32_t stream, double box, double scale)
{
    const sim_touches_t *of = touch->of;
    if (!is_polled(stream)) {
        return box;
    }
    return fmax(box + (touch->change->scan_us - of->scan_us) * scale, 0.0);
}

/*
 * Standard deviation of what a fine grid adds to a coarse one that it does not hold.
 *
 * It holds none whose steps are no whole number of its own. Beside the box of the coarse grid that
 * of the fine one only takes the edges off.
 */
static double rounded_again(double coarser, double fine, bool is_held)
{
    double steps = coarser / fine;
    bool   is_whole = is_held && fabs(steps - rint(steps)) < ROUNDING;
    return coarser > 0.0 && !is_whole ? fine / BOX_DEVIATION : 0.0;
}

static double norm(double a, double b)
{
    return fabs(b) > 0.0 ? sqrt(square(a) + square(b)) : a;
}

/* Scatter of when the pin changes: at a machine that of a length, passed at another speed. */
static double scatter_us(const touch_t *touch, double believed_us)
{
    return touch->of->is_machine != 0u ? believed_us / touch->ratio : believed_us;
}

static sim_law_t latch_law(const touch_t *touch, uint32_t stream, sim_law_t law)
{
    const sim_change_t *change = touch->change;
    bool                is_held = fabs(change->tick_line_us) <= 0.0;
    double              stamp_us = number_at(change->stamp_us, touch->i);
    double              rounded = rounded_again(touch->coarser_us, touch->of->tick_us, is_held);
    law.offset += mechanics_us(touch) + stamp_us + path_us(touch, stream) - touch->coarser_us;
    law.sigma = norm(scatter_us(touch, law.sigma), rounded);
    law.box_a = wait_box(touch, stream, law.box_a, 1.0);
    law.box_b += touch->coarser_us;
    return law;
}

/* By how much the position of a scan is later than its coarse stamp, at the most. On the skip path
 * the position is captured along with the tick. */
static double after_stamp_us(const touch_t *touch)
{
    return touch->of->is_plc[touch->i] != 0u ? touch->coarser_us : 0.0;
}

static sim_law_t position_law(const touch_t *touch, sim_law_t law)
{
    const sim_touches_t *of = touch->of;
    const sim_change_t  *change = touch->change;
    uint64_t             i = touch->i;
    double               later = of->is_machine != 0u ? contact_us(touch) : 0.0;
    double               since_us = of->latch_us[i] - of->begin_us[i];
    double               way = touch->speed * (since_us - number_at(change->stamp_us, i) - later);
    double               shift = way - of->speed[i] * since_us + position_um(touch);
    law.offset += shift - touch->coarser_um / 2.0;
    law.sigma = norm(law.sigma, position_sigma_um(touch));
    law.box_a = law.box_a * touch->ratio + touch->speed * after_stamp_us(touch);
    law.box_b += touch->coarser_um;
    return law;
}

static sim_law_t deviation_law(const touch_t *touch, uint32_t stream, sim_law_t law)
{
    const sim_touches_t *of = touch->of;
    const sim_change_t  *change = touch->change;
    uint64_t             i = touch->i;
    double               delays_us = number_at(change->pin_us, i) + path_us(touch, stream);
    double               faster = touch->speed - of->speed[i];
    double shift = pretravel_um(touch) - of->pretravel_um[i] + faster * of->wait_us[i] +
                   touch->speed * delays_us + position_um(touch);
    double sooner = is_polled(stream) ? 0.0 : touch->speed * touch->coarser_us;
    double box = law.box_a * touch->ratio;
    law.offset += shift - touch->coarser_um / 2.0 - sooner;
    law.sigma = norm(law.sigma, position_sigma_um(touch));
    law.box_a = wait_box(touch, stream, box, touch->speed);
    law.box_b += touch->coarser_um + sooner;
    return law;
}

static sim_law_t report_law(const touch_t *touch, sim_law_t law)
{
    const sim_change_t *change = touch->change;
    law.offset += number_at(change->report_us, touch->i) - number_at(change->stamp_us, touch->i);
    law.box_b += touch->coarser_us;
    return law;
}

sim_law_t touch_law(const sim_touches_t *of, uint32_t stream, const sim_law_t *chain,
                    const sim_change_t *change, uint64_t i)
{
    touch_t   touch = touch_at(of, change, i);
    sim_law_t law = *chain;
    if (stream == SIM_MOTION) {
        law.offset += contact_us(&touch);
        return law;
    }
    if (is_beyond_stamp(stream)) {
        return position_law(&touch, law);
    }
    if (stream == SIM_REPORT) {
        return report_law(&touch, law);
    }
    return is_deviation(stream) ? deviation_law(&touch, stream, law)
                                : latch_law(&touch, stream, law);
}

sim_extra_t touch_extra(const sim_touches_t *of, uint32_t stream, const sim_change_t *change,
                        uint32_t k, uint64_t i)
{
    const sim_some_t *some = &change->extras[stream][k];
    double            speed = of->speed[i] * number_at(change->speed_ratio, i);
    double            scale = is_deviation(stream) ? speed : 1.0;
    return (sim_extra_t){
        .share = some->share,
        .offset = number_at(some->offset, i) * scale,
        .width = number_at(some->width, i) * scale,
        .mean = number_at(some->mean, i) * scale,
        .sigma = number_at(some->sigma, i) * scale,
        .boxless = number_at(some->boxless, i),
    };
}
