#include "api/five_axis_cycle.h"

#include <stddef.h>

#include "api/five_axis_belief.h"
#include "api/five_axis_play.h"
#include "api/five_axis_requests.h"
#include "api/five_axis_setup.h"
#include "api/five_axis_station.h"

/* ---- parameters, and errors in words ---- */

int sim_measure_kinematics_set(sim_measure_kinematics_t *play, uint16_t id, double value,
                               int32_t word)
{
    if (word != KINEMATICS_NUMBER) {
        return (int)kinematics_settings_set_word(&play->settings, id, (kinematics_word_t)word);
    }
    return (int)kinematics_settings_set(&play->settings, id, value);
}

const char *sim_measure_kinematics_phrase(int setting_error)
{
    return kinematics_settings_phrase((kinematics_setting_error_t)setting_error);
}

const char *sim_measure_kinematics_fault_phrase(int error)
{
    return kinematics_cycle_phrase((kinematics_cycle_error_t)error);
}

const char *sim_measure_kinematics_limits(int32_t number, uint16_t id, double *low, double *high,
                                          double *initial)
{
    kinematics_kind_t                       kind = number == 452   ? KINEMATICS_COMPENSATE_PRESET
                                                   : number == 453 ? KINEMATICS_MEASURE_GRID
                                                                   : KINEMATICS_MEASURE;
    const kinematics_setting_description_t *row =
        kinematics_settings_of(kind, kinematics_settings_find(id));
    if (row == NULL) {
        return NULL;
    }
    *low = row->low;
    *high = row->high;
    *initial = row->initial;
    return row->name;
}

/* ---- the run ---- */

/* What the caller answers, or SIM_451_FAILED for what is answered here. */
static int asked(const kinematics_cycle_request_t *request)
{
    switch (request->kind) {
    case KINEMATICS_CYCLE_EVALUATE:
        return SIM_451_EVALUATE;
    case KINEMATICS_CYCLE_ACKNOWLEDGE:
        return SIM_451_ACKNOWLEDGE;
    case KINEMATICS_CYCLE_APPLY:
        return SIM_451_APPLY;
    case KINEMATICS_CYCLE_CLEAR:
        return SIM_451_CLEAR;
    default:
        return SIM_451_FAILED;
    }
}

static int run_on(sim_measure_kinematics_t *play)
{
    kinematics_cycle_request_t request;
    while (kinematics_cycle_poll(&play->cycle, &play->input) == KINEMATICS_CYCLE_RUNNING) {
        if (!kinematics_cycle_take_request(&play->cycle, &request)) {
            play->input.outcome = KINEMATICS_CYCLE_CARRIED_OUT;
            continue;
        }
        int question = asked(&request);
        if (question != SIM_451_FAILED) {
            play->change_mm = request.change_mm;
            return question;
        }
        play->input.outcome = five_axis_carry_out(play, &request) ? KINEMATICS_CYCLE_CARRIED_OUT
                                                                  : KINEMATICS_CYCLE_IMPOSSIBLE;
    }
    return play->cycle.state == KINEMATICS_CYCLE_DONE ? SIM_451_DONE : SIM_451_FAILED;
}

int sim_measure_kinematics_run(sim_measure_kinematics_t *play)
{
    if (!play->is_started) {
        kinematics_cycle_machine_t machine = five_axis_described(play);
        play->is_started = true;
        play->input.outcome = KINEMATICS_CYCLE_CARRIED_OUT;
        if (kinematics_cycle_start(&play->cycle, &play->settings, &machine) !=
            KINEMATICS_CYCLE_OK) {
            return SIM_451_FAILED;
        }
    }
    return run_on(play);
}

int sim_measure_kinematics_run_measured(sim_measure_kinematics_t *play,
                                        const sim_station_t *stations, uint32_t n)
{
    kinematics_cycle_machine_t machine = five_axis_described(play);
    kinematics_station_t       measured[KINEMATICS_STATIONS_MAX];
    uint32_t count = n <= KINEMATICS_STATIONS_MAX ? n : 0u; /* the cycle refuses none */
    for (uint32_t i = 0u; i < count; ++i) {
        measured[i] = five_axis_station(&stations[i]);
    }
    play->is_started = true;
    play->input.outcome = KINEMATICS_CYCLE_CARRIED_OUT;
    if (kinematics_cycle_start_measured(&play->cycle, &play->settings, &machine, measured,
                                        (uint8_t)count) != KINEMATICS_CYCLE_OK) {
        return SIM_451_FAILED;
    }
    return run_on(play);
}

int sim_measure_kinematics_answer(sim_measure_kinematics_t *play, double change_mm,
                                  int32_t is_possible)
{
    play->input.change_mm = change_mm;
    play->input.outcome =
        is_possible != 0 ? KINEMATICS_CYCLE_CARRIED_OUT : KINEMATICS_CYCLE_IMPOSSIBLE;
    return run_on(play);
}

/* ---- what is to be read of it ---- */

void sim_machine_expect(const sim_machine_t *believed, const double sphere_mm[3],
                        const double angle_deg[3], double reading_mm[3])
{
    five_axis_belief_t belief;
    five_axis_believe(&belief, believed);
    five_axis_expect(&belief, sphere_mm, angle_deg, reading_mm);
}

void sim_machine_compensation(const sim_machine_t *believed, const double angle_deg[3],
                              double offset_mm[3])
{
    five_axis_belief_t belief;
    five_axis_believe(&belief, believed);
    five_axis_compensation(&belief, angle_deg, offset_mm);
}

uint32_t sim_measure_kinematics_stations(const sim_measure_kinematics_t *play,
                                         sim_station_t *stations, uint32_t capacity)
{
    const kinematics_plan_t *plan = kinematics_cycle_plan(&play->cycle);
    for (uint32_t i = 0; i < plan->measured && i < capacity; ++i) {
        const kinematics_station_t *from = &plan->stations[i];
        stations[i] = (sim_station_t){
            .radius_mm = from->radius_mm,
            .axis = from->axis,
            .serves = from->serves,
            .approach = from->approach,
            .is_reference = from->is_reference,
            .is_second = from->is_second,
        };
        five_axis_copy(stations[i].angle_deg, from->angle_deg);
        five_axis_copy(stations[i].centre_mm, from->centre_mm);
    }
    return plan->measured;
}

void sim_measure_kinematics_report(const sim_measure_kinematics_t  *play,
                                   sim_measure_kinematics_report_t *report)
{
    const kinematics_cycle_fault_t         *fault = kinematics_cycle_fault(&play->cycle);
    const kinematics_setting_description_t *row =
        kinematics_settings_describe((uint32_t)fault->parameter);
    *report = (sim_measure_kinematics_report_t){
        .change_mm = play->change_mm,
        .duration_s = play->duration_s,
        .touches = play->touches,
        .error = (int32_t)fault->error,
        .parameter = row == NULL ? 0 : row->id,
        .touch_error = play->rig.error,
        .cancelled_rotation = play->is_rotation_cancelled,
        .presets = play->presets,
        .is_tilted = play->is_tilted,
    };
    five_axis_copy(report->tilt_deg, play->tilt_deg);
    five_axis_copy(report->preset_mm, play->preset_mm);
}
