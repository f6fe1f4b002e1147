/* What the library's entries to the five-axis machine refuse, with a code of its own each. */
/* LINK: tests/support/play.c $(OUT)/libskiplatch_sim.a */
#include <math.h>
#include <stddef.h>

#include "api/five_axis_cycle.h"
#include "api/five_axis_points.h"
#include "effects/active.h"
#include "play.h"
#include "unity.h"

static sim_machine_t    truth;
static sim_machine_t    believed;
static sim_chain_t      chain;
static sim_controller_t controller;
static sim_control_t    control;
static sim_probing_t    probing;
static sim_setting_t    setting;
static sim_sphere_t     sphere;
static sim_rig_t        rig;

void setUp(void)
{
    truth = (sim_machine_t){
        .axes = {{.direction = {1.0, 0.0, 0.0}},
                 {.direction = {0.0, 1.0, 0.0}},
                 {.direction = {0.0, 0.0, 1.0}}},
        .table = {SIM_ROTARY_B, SIM_ROTARY_C, -1},
        .head = {-1, -1, -1},
        .sphere_mm = {100.0, 0.0, 50.0},
        .sphere_radius_mm = 12.5,
        .tip_radius_mm = 3.0,
    };
    believed = truth;
    chain = PLAY_MACHINE;
    controller = PLAY_ONE_TOUCH;
    control = (sim_control_t){.touch_feed_mm_min = 120.0, .path = SIM_PATH_SKIP};
    probing =
        (sim_probing_t){.feed_mm_min = 120.0, .stand_off_mm = 6.0, .search_mm = 6.0, .touches = 4};
    sphere = (sim_sphere_t){.angle_deg = {0.0, 0.0, 10.0}};
    rig = (sim_rig_t){.chain = &chain, .controller = &controller, .settings = &setting, .seed = 1u};
}

void tearDown(void)
{
}

static void check_both(int expected)
{
    sim_measure_kinematics_t *play = NULL;
    TEST_ASSERT_EQUAL_INT(expected,
                          sim_measure_kinematics_open(&rig, &truth, &believed, &control, &play));
    TEST_ASSERT_EQUAL_INT(expected == SIM_PLAY_OK, play != NULL);
    sim_measure_kinematics_close(play);
    int32_t measured = sim_five_axis_points(&rig, &truth, &believed, &probing, &sphere, 1u);
    TEST_ASSERT_EQUAL_INT(expected == SIM_PLAY_OK ? 1 : expected, measured);
    setUp();
}

void test_a_sound_machine_is_played(void)
{
    check_both(SIM_PLAY_OK);
}

void test_a_chain_that_cannot_be_played_is_refused(void)
{
    chain.scan_us = NAN;
    check_both(SIM_PLAY_ERR_CHAIN);
    chain.tick_us = 0.0;
    check_both(SIM_PLAY_ERR_CHAIN);
    controller.reaction_us = -1.0;
    check_both(SIM_PLAY_ERR_CONTROL);
}

void test_an_effect_that_there_is_not_is_refused(void)
{
    rig.settings_count = 1u;
    setting = (sim_setting_t){.effect = 10000};
    check_both(SIM_PLAY_ERR_EFFECT);
    rig.settings_count = 1u;
    setting = (sim_setting_t){.effect = 0, .parameters = {NAN}};
    check_both(SIM_PLAY_ERR_EFFECT);
    rig.settings_count = SIM_EFFECTS_MAX + 1u;
    check_both(SIM_PLAY_ERR_EFFECT);
}

void test_a_machine_true_or_believed_that_is_none_is_refused(void)
{
    truth.table[0] = 3;
    check_both(SIM_PLAY_ERR_MACHINE);
    believed.table[1] = SIM_ROTARY_B;
    check_both(SIM_PLAY_ERR_MACHINE);
}

void test_a_grid_with_too_many_nodes_or_no_numbers_is_refused(void)
{
    believed.grid.count[1] = 26;
    check_both(SIM_PLAY_ERR_MACHINE);
    believed.grid.count[2] = -1;
    check_both(SIM_PLAY_ERR_MACHINE);
    believed.grid.node_deg[2][24] = NAN;
    check_both(SIM_PLAY_ERR_MACHINE);
    believed.grid.offset_mm[74][2] = INFINITY;
    check_both(SIM_PLAY_ERR_MACHINE);
}

static void refuse_control(double *value, double bad)
{
    sim_measure_kinematics_t *play = NULL;
    *value = bad;
    TEST_ASSERT_EQUAL_INT(SIM_PLAY_ERR_CONTROL,
                          sim_measure_kinematics_open(&rig, &truth, &believed, &control, &play));
    TEST_ASSERT_NULL(play);
    setUp();
}

void test_a_set_up_that_is_none_is_refused(void)
{
    refuse_control(&control.touch_feed_mm_min, 0.0);
    refuse_control(&control.touch_feed_mm_min, NAN);
    refuse_control(&control.search_mm, -1.0);
    refuse_control(&control.start_above_mm, INFINITY);
    refuse_control(&control.start_deg[1], NAN);
    refuse_control(&control.preset_miss_mm[2], NAN);
    control.path = 2;
    refuse_control(&control.search_mm, 0.0);
}

static void refuse_probing(void)
{
    TEST_ASSERT_EQUAL_INT(SIM_PLAY_ERR_CONTROL,
                          sim_five_axis_points(&rig, &truth, &believed, &probing, &sphere, 1u));
    setUp();
}

void test_a_way_of_probing_that_is_none_is_refused(void)
{
    static const int32_t TOUCHES[] = {2, 9, -1, 260};
    for (size_t i = 0u; i < sizeof TOUCHES / sizeof *TOUCHES; ++i) {
        probing.touches = TOUCHES[i];
        refuse_probing();
    }
    probing.feed_mm_min = 0.0;
    refuse_probing();
    probing.stand_off_mm = NAN;
    refuse_probing();
    probing.search_mm = -1.0;
    refuse_probing();
    probing.reference_deg = INFINITY;
    refuse_probing();
    probing.path = -1;
    refuse_probing();
    sphere.angle_deg[0] = NAN;
    refuse_probing();
}
