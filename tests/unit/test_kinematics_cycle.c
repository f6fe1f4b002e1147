/* Cycle 451 from its start to its end: what it asks for, in which order, and what it finds. */
/* LINK: firmware/comp/kinematics_grid.c firmware/cycle/kinematics_conditions.c
 *       firmware/cycle/kinematics_cycle.c firmware/cycle/kinematics_cycle_start.c
 *       firmware/cycle/kinematics_plan.c firmware/cycle/kinematics_requests.c
 *       firmware/cycle/kinematics_stance.c
 *       firmware/cycle/kinematics_settings.c firmware/cycle/sphere_probe.c
 *       tests/support/cycle451_machine.c */
#include <math.h>

#include "cycle451_machine.h"
#include "unity.h"

#define TINY_MM 1e-9
#define PROBING 5                   /* touches for one sphere with Q423 = 4 */
#define LAST    (machine.count - 2) /* before 3-D ROT, which ends every cycle */

static cycle451_machine_t machine;

void setUp(void)
{
    cycle451_set_up(&machine);
}

void tearDown(void)
{
}

static int asked(kinematics_cycle_request_kind_t kind)
{
    return cycle451_asked(&machine, kind);
}

static int first(kinematics_cycle_request_kind_t kind)
{
    return cycle451_find(&machine, kind, 0);
}

static void check_done(void)
{
    TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_DONE, cycle451_run(&machine));
    TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_OK, kinematics_cycle_fault(&machine.cycle)->error);
}

void test_the_first_program_measures_five_spheres_and_changes_nothing(void)
{
    check_done();

    TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_CANCEL_ROTATION, machine.log[0].kind);
    TEST_ASSERT_EQUAL(1, asked(KINEMATICS_CYCLE_CANCEL_ROTATION));
    TEST_ASSERT_EQUAL(5 * PROBING, asked(KINEMATICS_CYCLE_TOUCH));
    TEST_ASSERT_EQUAL(5, kinematics_cycle_plan(&machine.cycle)->measured);
    TEST_ASSERT_EQUAL(1, asked(KINEMATICS_CYCLE_EVALUATE));
    TEST_ASSERT_EQUAL(LAST, first(KINEMATICS_CYCLE_EVALUATE));
    TEST_ASSERT_EQUAL(0, asked(KINEMATICS_CYCLE_APPLY));
    TEST_ASSERT_EQUAL(0, asked(KINEMATICS_CYCLE_SET_PRESET));
}

void test_centres_and_radii_are_those_of_the_sphere(void)
{
    cycle451_set(&machine, 414, 3);
    cycle451_set(&machine, 413, 10);
    cycle451_set(&machine, 421, -20);
    check_done();

    const kinematics_plan_t *plan = kinematics_cycle_plan(&machine.cycle);
    TEST_ASSERT_EQUAL(plan->count, plan->measured);
    for (int i = 0; i < plan->count; i++) {
        double centre[3];
        cycle451_centre(&machine, plan->stations[i].angle_deg, centre);
        for (int k = 0; k < 3; k++) {
            TEST_ASSERT_DOUBLE_WITHIN(TINY_MM, centre[k], plan->stations[i].centre_mm[k]);
        }
        TEST_ASSERT_DOUBLE_WITHIN(TINY_MM, 12.5, plan->stations[i].radius_mm);
    }
}

void test_every_number_of_touches_is_kept(void)
{
    for (int touches = 3; touches <= 8; touches++) {
        cycle451_set(&machine, 423, touches);
        check_done();
        TEST_ASSERT_EQUAL(5 * (1 + touches), asked(KINEMATICS_CYCLE_TOUCH));
    }
}

/* ---- ways ---- */

void test_axes_turn_one_by_one_a_then_b_then_c(void)
{
    cycle451_set(&machine, 413, 10);
    cycle451_set(&machine, 417, 15);
    cycle451_set(&machine, 421, 20);
    cycle451_set(&machine, 414, 2);
    check_done();

    /* To the reference of A: B, then C to their incidence angles; A, at 0 already, to start. */
    int b = first(KINEMATICS_CYCLE_TURN);
    int c = cycle451_find(&machine, KINEMATICS_CYCLE_TURN, b + 1);
    int a = cycle451_find(&machine, KINEMATICS_CYCLE_TURN, c + 1);
    TEST_ASSERT_EQUAL(ROTARY_B, machine.log[b].axis);
    TEST_ASSERT_EQUAL(ROTARY_C, machine.log[c].axis);
    TEST_ASSERT_EQUAL(b + 1, c);
    TEST_ASSERT_EQUAL_DOUBLE(15, machine.log[b].angle_deg[ROTARY_B]);
    TEST_ASSERT_EQUAL_DOUBLE(0, machine.log[b].angle_deg[ROTARY_C]);
    TEST_ASSERT_EQUAL_DOUBLE(20, machine.log[c].angle_deg[ROTARY_C]);
    TEST_ASSERT_EQUAL(ROTARY_A, machine.log[a].axis);
    TEST_ASSERT_EQUAL_DOUBLE(-90, machine.log[a].angle_deg[ROTARY_A]);
}

void test_from_the_last_station_of_a_the_axes_turn_in_order_to_the_reference_of_b(void)
{
    cycle451_set(&machine, 414, 1);
    cycle451_set(&machine, 421, 20);
    cycle451_set(&machine, 413, 5);
    check_done();

    const kinematics_plan_t *plan = kinematics_cycle_plan(&machine.cycle);
    TEST_ASSERT_EQUAL(ROTARY_B, plan->stations[2].axis);
    for (int i = 1; i < machine.count; i++) { /* neighbours without a measurement between */
        if (machine.log[i].kind == KINEMATICS_CYCLE_TURN &&
            machine.log[i - 1].kind == KINEMATICS_CYCLE_TURN) {
            TEST_ASSERT_GREATER_THAN(machine.log[i - 1].axis, machine.log[i].axis);
        }
    }
}

void test_without_a_retract_height_the_tip_follows_the_sphere(void)
{
    check_done();

    TEST_ASSERT_EQUAL(0, asked(KINEMATICS_CYCLE_RETRACT));
    TEST_ASSERT_TRUE(machine.log[first(KINEMATICS_CYCLE_TURN)].follow);
    TEST_ASSERT_EQUAL_DOUBLE(15 + 3, machine.log[first(KINEMATICS_CYCLE_TURN)].stand_off_mm);
    /* Above the pole, before the first turn. */
    const kinematics_cycle_request_t *move = &machine.log[first(KINEMATICS_CYCLE_MOVE)];
    TEST_ASSERT_EQUAL_DOUBLE(80, move->target_mm[0]);
    TEST_ASSERT_EQUAL_DOUBLE(20, move->target_mm[1]);
    TEST_ASSERT_EQUAL_DOUBLE(40 + 15 + 3, move->target_mm[2]);
}

void test_a_retract_height_comes_before_every_turn_and_at_the_end(void)
{
    cycle451_set(&machine, 408, 150);
    check_done();

    TEST_ASSERT_EQUAL(6, asked(KINEMATICS_CYCLE_RETRACT)); /* five stations, and the end */
    for (int i = 0; i < machine.count; i++) {
        if (machine.log[i].kind == KINEMATICS_CYCLE_RETRACT) {
            TEST_ASSERT_EQUAL_DOUBLE(150, machine.log[i].retract_height_mm);
            TEST_ASSERT_EQUAL_DOUBLE(750, machine.log[i].feed_mm_min);
        }
        if (machine.log[i].kind == KINEMATICS_CYCLE_TURN) {
            TEST_ASSERT_FALSE(machine.log[i].follow);
            TEST_ASSERT_NOT_EQUAL(KINEMATICS_CYCLE_TOUCH, machine.log[i - 1].kind);
            TEST_ASSERT_NOT_EQUAL(KINEMATICS_CYCLE_MOVE, machine.log[i - 1].kind);
        }
    }
    TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_RETRACT, machine.log[LAST - 1].kind);
}

void test_a_turn_tells_where_the_sphere_was_measured_last(void)
{
    check_done();

    int turn = cycle451_find(&machine, KINEMATICS_CYCLE_TURN, first(KINEMATICS_CYCLE_TURN) + 1);
    const kinematics_cycle_request_t *request = &machine.log[turn];
    double                            centre[3];
    cycle451_centre(&machine, request->from_angle_deg, centre);
    TEST_ASSERT_EQUAL_DOUBLE(-90, request->from_angle_deg[ROTARY_B]);
    for (int k = 0; k < 3; k++) {
        TEST_ASSERT_DOUBLE_WITHIN(TINY_MM, centre[k], request->sphere_mm[k]);
    }
}

/* ---- feeds and clearance ---- */

static void check_feeds(double turn, double move)
{
    check_done();
    TEST_ASSERT_EQUAL_DOUBLE(turn, machine.log[first(KINEMATICS_CYCLE_TURN)].feed_mm_min);
    TEST_ASSERT_EQUAL_DOUBLE(move, machine.log[first(KINEMATICS_CYCLE_MOVE)].feed_mm_min);
}

void test_rotary_axes_turn_at_q253_and_the_watched_probe_at_the_smaller_feed(void)
{
    check_feeds(750, 600);
    cycle451_set(&machine, 253, 500);
    check_feeds(500, 500);
    kinematics_settings_set_word(&machine.settings, 253, KINEMATICS_FMAX);
    check_feeds(20000, 600);
    kinematics_settings_set_word(&machine.settings, 253, KINEMATICS_FAUTO);
    check_feeds(400, 400);
    kinematics_settings_set_word(&machine.settings, 253, KINEMATICS_PREDEF);
    check_feeds(300, 300);
}

void test_a_q253_of_0_is_the_feed_of_the_probe(void)
{
    cycle451_set(&machine, 253, 0);
    check_feeds(600, 600);
}

void test_clearance_comes_on_top_of_set_up(void)
{
    cycle451_set(&machine, 320, 2);
    check_done();
    TEST_ASSERT_EQUAL_DOUBLE(5, machine.log[first(KINEMATICS_CYCLE_TOUCH)].stand_off_mm);

    kinematics_settings_set_word(&machine.settings, 320, KINEMATICS_PREDEF);
    check_done();
    TEST_ASSERT_EQUAL_DOUBLE(10, machine.log[first(KINEMATICS_CYCLE_TOUCH)].stand_off_mm);
}

/* ---- M function ---- */

void test_an_m_function_turns_and_no_backlash_is_measured(void)
{
    machine.data.strobe_rot_ax_pos = 134;
    cycle451_set(&machine, 432, 0.5);
    check_done();

    TEST_ASSERT_EQUAL(0, asked(KINEMATICS_CYCLE_TURN));
    TEST_ASSERT_EQUAL(5, asked(KINEMATICS_CYCLE_TURN_BY_M_FUNCTION)); /* B back to 0, too */
    TEST_ASSERT_EQUAL(134, machine.log[first(KINEMATICS_CYCLE_TURN_BY_M_FUNCTION)].m_function);
    TEST_ASSERT_EQUAL(5, kinematics_cycle_plan(&machine.cycle)->measured);
}

/* ---- what goes wrong on the way ---- */

void test_whatever_request_fails_ends_the_cycle_there(void)
{
    cycle451_set(&machine, 406, 1);
    cycle451_set(&machine, 408, 100);
    cycle451_set(&machine, 431, 3);
    check_done();
    int all = machine.count;

    for (int i = 0; i < all; i++) {
        machine.impossible_at = i;
        TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_FAILED, cycle451_run(&machine));
        TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_ERR_REQUEST,
                          kinematics_cycle_fault(&machine.cycle)->error);
        TEST_ASSERT_EQUAL(i + 1, machine.count);
    }
}

void test_a_touch_that_is_no_number_is_no_sphere(void)
{
    kinematics_cycle_request_t request;
    kinematics_cycle_input_t   input = {.outcome = KINEMATICS_CYCLE_CARRIED_OUT,
                                        .centre_mm = {80, 20, 40},
                                        .tool_axis = {0, 0, 1},
                                        .touched_mm = {NAN, NAN, NAN}};
    cycle451_start(&machine);
    while (kinematics_cycle_take_request(&machine.cycle, &request)) {
        kinematics_cycle_poll(&machine.cycle, &input);
    }

    TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_FAILED, machine.cycle.state);
    TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_ERR_NO_SPHERE,
                      kinematics_cycle_fault(&machine.cycle)->error);
}

void test_a_busy_caller_is_waited_for(void)
{
    kinematics_cycle_request_t request;
    kinematics_cycle_input_t   busy = {.outcome = KINEMATICS_CYCLE_BUSY};
    kinematics_cycle_input_t   done = {.outcome = KINEMATICS_CYCLE_CARRIED_OUT};

    cycle451_start(&machine);
    TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_RUNNING, kinematics_cycle_poll(&machine.cycle, &done));
    TEST_ASSERT_TRUE(kinematics_cycle_take_request(&machine.cycle, &request));
    TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_CANCEL_ROTATION, request.kind); /* not polled over */
    TEST_ASSERT_FALSE(kinematics_cycle_take_request(&machine.cycle, &request));
    TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_RUNNING, kinematics_cycle_poll(&machine.cycle, &busy));
    TEST_ASSERT_FALSE(kinematics_cycle_take_request(&machine.cycle, &request));

    kinematics_cycle_poll(&machine.cycle, &done);
    TEST_ASSERT_TRUE(kinematics_cycle_take_request(&machine.cycle, &request));
    TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_MOVE, request.kind);
}

void test_a_cycle_that_was_never_started_does_nothing(void)
{
    kinematics_cycle_request_t request;
    kinematics_cycle_input_t   done = {.outcome = KINEMATICS_CYCLE_CARRIED_OUT};

    TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_IDLE, kinematics_cycle_poll(&machine.cycle, &done));
    TEST_ASSERT_FALSE(kinematics_cycle_take_request(&machine.cycle, &request));
}
