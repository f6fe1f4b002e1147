/* Cycle 451: what it changes, the preset and the kinematics, and when it leaves them alone. */
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

static void check_failed(kinematics_cycle_error_t error)
{
    TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_FAILED, cycle451_run(&machine));
    TEST_ASSERT_EQUAL(error, kinematics_cycle_fault(&machine.cycle)->error);
    TEST_ASSERT_EQUAL(0, asked(KINEMATICS_CYCLE_APPLY));
}

/* ---- preset ---- */

void test_presetting_before_probes_twice_and_spares_the_reference(void)
{
    cycle451_set(&machine, 431, 1);
    machine.data.position_mm[0] += 3.0; /* put there by eye */
    machine.data.position_mm[2] -= 1.0;
    machine.data.preset_mm[0] = 999.0; /* does not matter yet */
    check_done();

    int preset = first(KINEMATICS_CYCLE_SET_PRESET);
    TEST_ASSERT_EQUAL(1, asked(KINEMATICS_CYCLE_SET_PRESET));
    TEST_ASSERT_EQUAL(preset, first(KINEMATICS_CYCLE_TURN) - 2); /* then above the pole */
    for (int k = 0; k < 3; k++) {
        TEST_ASSERT_DOUBLE_WITHIN(TINY_MM, machine.sphere_mm[k], machine.log[preset].sphere_mm[k]);
    }
    TEST_ASSERT_EQUAL((2 + 4) * PROBING, asked(KINEMATICS_CYCLE_TOUCH));
    TEST_ASSERT_EQUAL(5, kinematics_cycle_plan(&machine.cycle)->measured);
    TEST_ASSERT_DOUBLE_WITHIN(TINY_MM, 80.0, machine.cycle.plan.stations[0].centre_mm[0]);
}

void test_a_preset_elsewhere_does_not_spare_the_reference(void)
{
    cycle451_set(&machine, 431, 1);
    machine.data.angle_deg[ROTARY_C] = 10.0;
    double centre[3];
    cycle451_centre(&machine, machine.data.angle_deg, centre);
    for (int k = 0; k < 3; k++) {
        machine.data.position_mm[k] = centre[k] + (k == 2 ? 18.0 : 0.0);
    }
    check_done();

    TEST_ASSERT_EQUAL((2 + 5) * PROBING, asked(KINEMATICS_CYCLE_TOUCH));
    TEST_ASSERT_EQUAL_DOUBLE(10.0,
                             machine.log[first(KINEMATICS_CYCLE_SET_PRESET)].angle_deg[ROTARY_C]);
}

void test_the_same_position_again_is_measured_again(void)
{
    cycle451_set(&machine, 431, 1);
    cycle451_set(&machine, 418, 0);
    cycle451_set(&machine, 419, 90);
    cycle451_set(&machine, 422, 3); /* 90° three times */
    check_done();

    TEST_ASSERT_EQUAL((2 + 3) * PROBING, asked(KINEMATICS_CYCLE_TOUCH));
}

void test_presetting_after_uses_the_reference(void)
{
    cycle451_set(&machine, 431, 2);
    check_done();

    TEST_ASSERT_EQUAL(1, asked(KINEMATICS_CYCLE_SET_PRESET));
    TEST_ASSERT_EQUAL(LAST, first(KINEMATICS_CYCLE_SET_PRESET));
    TEST_ASSERT_EQUAL(5 * PROBING, asked(KINEMATICS_CYCLE_TOUCH));
    TEST_ASSERT_DOUBLE_WITHIN(TINY_MM, 80.0, machine.log[LAST].sphere_mm[0]);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, machine.log[LAST].angle_deg[ROTARY_C]);
}

void test_presetting_before_and_after_does_both(void)
{
    cycle451_set(&machine, 431, 3);
    cycle451_set(&machine, 406, 1);
    check_done();

    TEST_ASSERT_EQUAL(2, asked(KINEMATICS_CYCLE_SET_PRESET));
    TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_APPLY, machine.log[LAST - 1].kind);
    TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_SET_PRESET, machine.log[LAST].kind);
}

void test_3d_rot_is_active_at_the_end_as_the_axes_stand(void)
{
    for (int preset = 0; preset <= 3; preset++) {
        cycle451_set(&machine, 431, preset);
        cycle451_set(&machine, 417, 15);
        check_done();

        const kinematics_cycle_request_t *last = &machine.log[machine.count - 1];
        TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_TILT, last->kind);
        TEST_ASSERT_EQUAL(1, asked(KINEMATICS_CYCLE_TILT));
        TEST_ASSERT_EQUAL_DOUBLE(0, last->angle_deg[ROTARY_A]);
        TEST_ASSERT_EQUAL_DOUBLE(15, last->angle_deg[ROTARY_B]);
        TEST_ASSERT_EQUAL_DOUBLE(90, last->angle_deg[ROTARY_C]);
    }
}

/* ---- radius of the sphere ---- */

void test_a_sphere_of_another_radius_ends_the_measurement(void)
{
    machine.radius_mm = 12.5 + 0.0999;
    check_done();

    machine.radius_mm = 12.5 + 0.1001;
    check_failed(KINEMATICS_CYCLE_ERR_BALL_RADIUS);
    TEST_ASSERT_EQUAL(KINEMATICS_Q407_SPHERE_RADIUS,
                      kinematics_cycle_fault(&machine.cycle)->parameter);
    TEST_ASSERT_EQUAL(PROBING, asked(KINEMATICS_CYCLE_TOUCH));

    machine.radius_mm = 12.5 - 0.1001;
    check_failed(KINEMATICS_CYCLE_ERR_BALL_RADIUS);
}

void test_the_search_for_the_sphere_does_not_look_at_its_radius(void)
{
    cycle451_set(&machine, 431, 1);
    machine.radius_mm = 12.7;
    check_failed(KINEMATICS_CYCLE_ERR_BALL_RADIUS);

    TEST_ASSERT_EQUAL(2 * PROBING, asked(KINEMATICS_CYCLE_TOUCH));
    TEST_ASSERT_EQUAL(0, asked(KINEMATICS_CYCLE_SET_PRESET));
}

void test_without_a_limit_any_radius_will_do(void)
{
    machine.data.max_dev_cal_ball_mm = 0.0;
    machine.radius_mm = 12.9;
    check_done();
}

/* ---- correction ---- */

void test_every_correcting_mode_applies_what_was_evaluated(void)
{
    for (int mode = 1; mode <= 3; mode++) {
        cycle451_set(&machine, 406, mode);
        machine.change_mm = machine.data.max_modification_mm; /* at the limit: no warning */
        check_done();
        TEST_ASSERT_EQUAL(1, asked(KINEMATICS_CYCLE_APPLY));
        TEST_ASSERT_EQUAL(0, asked(KINEMATICS_CYCLE_ACKNOWLEDGE));
    }
}

void test_a_change_above_the_limit_has_to_be_acknowledged(void)
{
    cycle451_set(&machine, 406, 1);
    machine.change_mm = nextafter(machine.data.max_modification_mm, 2.0);
    check_done();

    TEST_ASSERT_EQUAL(1, asked(KINEMATICS_CYCLE_ACKNOWLEDGE));
    TEST_ASSERT_EQUAL(first(KINEMATICS_CYCLE_ACKNOWLEDGE) + 1, first(KINEMATICS_CYCLE_APPLY));
    TEST_ASSERT_EQUAL_DOUBLE(machine.change_mm,
                             machine.log[first(KINEMATICS_CYCLE_ACKNOWLEDGE)].change_mm);

    machine.change_mm = NAN;
    check_done();
    TEST_ASSERT_EQUAL(1, asked(KINEMATICS_CYCLE_ACKNOWLEDGE));
}

void test_a_refused_change_leaves_the_kinematics(void)
{
    cycle451_set(&machine, 406, 1);
    machine.change_mm = 2.0;
    check_done();

    machine.impossible_at = first(KINEMATICS_CYCLE_ACKNOWLEDGE);
    check_failed(KINEMATICS_CYCLE_ERR_REFUSED);
}

void test_checking_shows_no_warning(void)
{
    machine.change_mm = 100.0;
    check_done();
    TEST_ASSERT_EQUAL(0, asked(KINEMATICS_CYCLE_ACKNOWLEDGE));
}
