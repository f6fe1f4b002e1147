#include "api/batch.h"

#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdlib.h>

#include "api/rig.h"
#include "cycle/touch_cycle.h"
#include "effects/table.h"
#include "input/plc_task.h"
#include "seat.h"

/* A controller is switched on anew for every block, so that blocks can be played on any thread. */
#define BLOCK_TOUCHES 4096u

#define PARAMETERS (sizeof((sim_setting_t *)0)->parameters / sizeof(double))

#define LENGTH_MAX_MM   10000.0
#define FEED_MAX_MM_MIN 1.0e6
#define DURATION_MAX_US 1.0e9
#define TICK_MIN_US     1.0e-3
#define TICK_MAX_US     1.0e3
#define SEAT_MIN        1.0e-6 /* of what a seat cannot be without, each in its unit */
#define SEAT_MAX        1.0e6
#define POLE_DEG        90.0

typedef struct {
    const sim_rig_t     *rig;
    const sim_touch_t   *touches;
    sim_outcome_t       *outcomes;
    uint64_t             n;
    uint64_t             block;  /* touches */
    uint64_t             blocks; /* of one replicate */
    uint64_t             work;   /* blocks of all replicates */
    atomic_uint_fast64_t taken;
    atomic_int           result;
} job_t;

/* False for a NaN as well. */
static bool is_within(double value, double low, double high)
{
    return value >= low && value <= high;
}

static bool is_duration(double us)
{
    return is_within(us, 0.0, DURATION_MAX_US);
}

/* One that is not there may have no size either. */
static bool is_seat(const sim_seat_t *seat)
{
    double least = seat->spring_n > 0.0 ? SEAT_MIN : 0.0;
    return is_within(seat->spring_n, 0.0, SEAT_MAX) && is_within(seat->seat_mm, least, SEAT_MAX) &&
           is_within(seat->stylus_mm, least, SEAT_MAX) &&
           is_within(seat->stem_n_m2, least, SEAT_MAX) &&
           is_within(seat->axial_um_n, 0.0, SEAT_MAX) && is_within(seat->evenness, 0.0, 1.0) &&
           isfinite(seat->azimuth_deg) && is_within(seat->reseat_um, 0.0, LENGTH_MAX_MM);
}

static bool is_chain(const sim_chain_t *chain)
{
    double least_um = chain->is_signed ? -LENGTH_MAX_MM : 0.0;
    bool   probe = is_within(chain->pretravel_um, least_um, LENGTH_MAX_MM) &&
                   is_within(chain->lobe_um, -LENGTH_MAX_MM, LENGTH_MAX_MM) &&
                   isfinite(chain->lobe_phase_deg) &&
                   is_within(chain->repeatability_um, 0.0, LENGTH_MAX_MM) &&
                   is_duration(chain->delay_us);
    bool   input = is_duration(chain->filter_us) && is_duration(chain->skip_latency_us) &&
                   is_duration(chain->skip_jitter_us) &&
                   is_within(chain->tick_us, TICK_MIN_US, TICK_MAX_US) &&
                   is_within(chain->scan_us, PLC_PERIOD_MIN_US, PLC_PERIOD_MAX_US);
    bool   axis = is_within(chain->resolution_um, 1.0e-4, 1.0e4) &&
                  is_within(chain->accel_mm_s2, 1.0e-3, 1.0e6);
    bool   report = is_duration(chain->report_latency_us) && is_duration(chain->report_jitter_us) &&
                    is_duration(chain->reference_jitter_us);
    return probe && is_seat(&chain->seat) && input && axis && report;
}

static bool is_controller(const sim_controller_t *controller)
{
    bool motion = is_within(controller->overtravel_mm, 0.0, LENGTH_MAX_MM) &&
                  is_duration(controller->reaction_us);
    bool two =
        !controller->two_touches || (is_within(controller->back_off_mm, 0.0, LENGTH_MAX_MM) &&
                                     is_within(controller->fast_feed_mm_min, 0.0, FEED_MAX_MM_MIN));
    return motion && two && is_duration(controller->confirm_us) &&
           is_duration(controller->holdoff_us) && is_duration(controller->settle_us) &&
           is_duration(controller->scan_phase_us) && is_duration(controller->scan_spread_us) &&
           is_duration(controller->start_spread_us) &&
           is_within(controller->image_delay_scans, 0.0, PLC_IMAGE_DELAY_MAX);
}

static bool are_finite(const double *values, size_t count)
{
    for (size_t i = 0u; i < count; ++i) {
        if (!isfinite(values[i])) {
            return false;
        }
    }
    return true;
}

static bool is_touch(const sim_touch_t *touch)
{
    return is_within(touch->time_s, 0.0, (double)SIM_NS_MAX / SIM_NS_PER_S) &&
           is_within(touch->feed_mm_min, 1.0e-3, FEED_MAX_MM_MIN) &&
           is_within(touch->approach_mm, 1.0e-6, LENGTH_MAX_MM) && isfinite(touch->alpha_deg) &&
           isfinite(touch->beta_deg) && isfinite(touch->sign) && isfinite(touch->position_mm) &&
           isfinite(touch->rotary_deg) && isfinite(touch->datum_um) &&
           isfinite(touch->surface_um) && isfinite(touch->temp_c) &&
           are_finite(touch->further_temp_c, SIM_FURTHER_THERMOMETERS) &&
           is_duration(touch->pulse_us) &&
           (touch->path == SIM_PATH_SKIP || touch->path == SIM_PATH_PLC);
}

/* A seat has no contacts against a pull. */
static bool are_touches(const sim_chain_t *chain, const sim_touch_t *touches, uint64_t n)
{
    for (uint64_t i = 0; i < n; ++i) {
        bool is_pushed = !sim_has_seat(chain) || is_within(touches[i].beta_deg, 0.0, POLE_DEG);
        if (!is_touch(&touches[i]) || !is_pushed) {
            return false;
        }
    }
    return true;
}

/* Below the range is as bad as above; the order keeps several effects on one quantity defined. */
static bool is_setting(const sim_setting_t *setting)
{
    const sim_effect_t *effect = sim_effect_at((uint32_t)setting->effect);
    if (effect == NULL) {
        return false;
    }
    const sim_parameter_t *parameter = effect->about.parameters;
    for (uint32_t i = 0; i < PARAMETERS && parameter[i].name != NULL; ++i) {
        if (!is_within(setting->parameters[i], parameter[i].low, parameter[i].high)) {
            return false;
        }
    }
    return true;
}

static bool are_settings(const sim_setting_t *settings, uint32_t count)
{
    if (count > SIM_EFFECTS_MAX) {
        return false;
    }
    for (uint32_t i = 0; i < count; ++i) {
        if (!is_setting(&settings[i]) || (i > 0u && settings[i].effect < settings[i - 1u].effect)) {
            return false;
        }
    }
    return true;
}

static int play_block(const job_t *job, rig_t *rig, uint64_t number)
{
    uint64_t         replicate = number / job->blocks;
    uint64_t         begin = number % job->blocks * job->block;
    uint64_t         end = begin + job->block < job->n ? begin + job->block : job->n;
    sim_outcome_t   *outcomes = job->outcomes + replicate * job->n;
    const sim_rig_t *is = job->rig;

    rig_boot(rig, is->chain, is->controller, is->settings, is->settings_count, is->seed,
             is->replicate + replicate, sim_ns_from_s(job->touches[begin].time_s));
    for (uint64_t i = begin; i < end; ++i) {
        int wrong = rig_play(rig, &job->touches[i], &outcomes[i]);
        if (wrong != 0) {
            return wrong == RIG_ERR_CLOCK ? SIM_PLAY_ERR_CLOCK : SIM_PLAY_ERR_START;
        }
    }
    return SIM_PLAY_OK;
}

static void *play_blocks(void *argument)
{
    job_t *job = argument;
    rig_t  rig;
    for (;;) {
        uint64_t number = atomic_fetch_add(&job->taken, 1u);
        if (number >= job->work || atomic_load(&job->result) != SIM_PLAY_OK) {
            return NULL;
        }
        int result = play_block(job, &rig, number);
        if (result != SIM_PLAY_OK) {
            atomic_store(&job->result, result);
        }
    }
}

/* The calling thread works too, so a helper that cannot be started costs time and nothing else. */
static int play_on_threads(job_t *job, uint32_t threads)
{
    uint32_t   helpers = threads - 1u;
    uint32_t   started = 0u;
    pthread_t *thread = calloc(helpers + 1u, sizeof *thread);
    if (thread == NULL) {
        return SIM_PLAY_ERR_MEMORY;
    }
    while (started < helpers && pthread_create(&thread[started], NULL, play_blocks, job) == 0) {
        ++started;
    }
    (void)play_blocks(job);
    while (started > 0u) {
        --started;
        (void)pthread_join(thread[started], NULL);
    }
    free(thread);
    return atomic_load(&job->result);
}

int sim_play_check(const sim_rig_t *rig)
{
    if (!is_chain(rig->chain)) {
        return SIM_PLAY_ERR_CHAIN;
    }
    if (!is_controller(rig->controller)) {
        return SIM_PLAY_ERR_CONTROL;
    }
    return are_settings(rig->settings, rig->settings_count) ? SIM_PLAY_OK : SIM_PLAY_ERR_EFFECT;
}

int sim_play(const sim_rig_t *rig, const sim_touch_t *touches, uint64_t n, uint64_t replicates,
             uint32_t threads, sim_outcome_t *outcomes)
{
    int wrong = sim_play_check(rig);
    if (wrong != SIM_PLAY_OK) {
        return wrong;
    }
    if (!are_touches(rig->chain, touches, n)) {
        return SIM_PLAY_ERR_TOUCH;
    }
    /* An effect or a seat may remember the touch before, so its replicates are not cut up. */
    uint64_t block = rig->settings_count == 0u && !sim_has_seat(rig->chain) ? BLOCK_TOUCHES : n;
    uint64_t blocks = block == 0u ? 0u : (n + block - 1u) / block;
    job_t    job = {
        .rig = rig,
        .touches = touches,
        .outcomes = outcomes,
        .block = block,
        .n = n,
        .blocks = blocks,
        .work = blocks * replicates,
    };
    uint64_t useful = job.work < threads ? job.work : threads;
    return useful == 0u ? SIM_PLAY_OK : play_on_threads(&job, (uint32_t)useful);
}

const sim_description_t *sim_effect_describe(uint32_t index)
{
    const sim_effect_t *effect = sim_effect_at(index);
    return effect == NULL ? NULL : &effect->about;
}

const char *sim_play_error(int code)
{
    switch (code) {
    case SIM_PLAY_OK:
        return "no error";
    case SIM_PLAY_ERR_CHAIN:
        return "a value of the nominal chain is out of the range that can be played: the "
               "firmware's "
               "scans take 100 to 20000 us, a tick of the clock 0.001 to 1000 us";
    case SIM_PLAY_ERR_CONTROL:
        return "a setting of the controller is not finite or out of range";
    case SIM_PLAY_ERR_TOUCH:
        return "a condition of a touch is not finite or out of range; a probe by its mechanics is "
               "pushed in directions of beta_deg 0 to 90";
    case SIM_PLAY_ERR_START:
        return "the firmware refused to start the input path";
    case SIM_PLAY_ERR_EFFECT:
        return "an effect is unknown, one too many, or one of its parameters is out of range";
    case SIM_PLAY_ERR_CLOCK:
        return "the device clock would run at less than half or more than twice its rate: the "
               "campaign is too long or too warm for such a drift";
    case SIM_PLAY_ERR_MACHINE:
        return "the five-axis machine has an axis twice or none, or a value that is out of range";
    case SIM_PLAY_ERR_MEMORY:
        return "out of memory";
    default:
        return "unknown error";
    }
}
