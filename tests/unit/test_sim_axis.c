/* The simulated axis: trapezoids from rest, stopped anywhere, and their inverse in time. */
/* LINK: host_sim/axis.c tests/support/dice.c */
#include <math.h>

#include "axis.h"
#include "dice.h"
#include "unity.h"

#define MOTIONS 2000u
#define SAMPLES 40u
#define START   123456789 /* ns */
#define TINY_UM 1e-6

static sim_axis_t axis;
static dice_t     dice;

/* A motion in mm and s, worked out by hand. */
typedef struct {
    double from;
    double sense;
    double accel;
    double speed;     /* the highest */
    double accel_end; /* times from the start */
    double decel_start;
} motion_t;

static motion_t motion;

void setUp(void)
{
    dice = dice_seed(1u);
}

void tearDown(void)
{
}

static double feed_mm_min(double speed_mm_s)
{
    return 60.0 * speed_mm_s;
}

static double way_mm(double time_s)
{
    double ramp = 0.5 * motion.accel * motion.accel_end * motion.accel_end;
    double end = motion.decel_start + motion.speed / motion.accel;
    if (time_s <= motion.accel_end) {
        return 0.5 * motion.accel * time_s * time_s;
    }
    if (time_s <= motion.decel_start) {
        return ramp + motion.speed * (time_s - motion.accel_end);
    }
    double braking = fmin(time_s, end) - motion.decel_start;
    return ramp + motion.speed * (motion.decel_start - motion.accel_end) + motion.speed * braking -
           0.5 * motion.accel * braking * braking;
}

static double expected_um(double time_s)
{
    return 1000.0 * (motion.from + motion.sense * way_mm(time_s));
}

static sim_ns_t ns_after_start(double time_s)
{
    return START + (sim_ns_t)llrint(time_s * 1e9);
}

static double end_s(void)
{
    return motion.decel_start + motion.speed / motion.accel;
}

static void place_and_move(double target_mm, double speed_mm_s)
{
    sim_axis_place(&axis, motion.accel, 1000.0 * motion.from, START);
    sim_axis_move(&axis, 1000.0 * target_mm, feed_mm_min(speed_mm_s), START);
}

/* Away from the surface, so that nothing but the length limits the speed. */
static void draw_motion(void)
{
    double length = dice_any_scale(&dice, 0.001, 100.0);
    double wanted = dice_any_scale(&dice, 0.01, 200.0);
    motion.sense = dice_below(&dice, 2u) == 0u ? 1.0 : -1.0;
    motion.accel = dice_any_scale(&dice, 50.0, 20000.0);
    motion.from =
        motion.sense > 0.0 ? dice_between(&dice, 0.0, 5.0) : dice_between(&dice, -5.0, 105.0);
    motion.speed = fmin(wanted, sqrt(motion.accel * length));
    motion.accel_end = motion.speed / motion.accel;
    motion.decel_start = length / motion.speed;
    place_and_move(motion.from + motion.sense * length, wanted);
}

static void check_position(sim_ns_t now)
{
    double slack_um = TINY_UM + 2e-6 * motion.speed; /* 2 ns */
    TEST_ASSERT_DOUBLE_WITHIN(slack_um, expected_um((double)(now - START) * 1e-9),
                              sim_axis_position_um(&axis, now));
}

static void check_whole_motion(void)
{
    for (unsigned i = 0u; i <= SAMPLES; ++i) {
        check_position(ns_after_start(end_s() * i / SAMPLES));
    }
    check_position(ns_after_start(motion.accel_end));
    check_position(ns_after_start(motion.decel_start));
    check_position(ns_after_start(2.0 * end_s()));
}

/* ---- motions ---- */

void test_an_axis_rests_where_it_was_placed(void)
{
    sim_axis_place(&axis, 3000.0, -1234.5, START);

    TEST_ASSERT_EQUAL_DOUBLE(-1234.5, sim_axis_position_um(&axis, START));
    TEST_ASSERT_EQUAL_DOUBLE(-1234.5, sim_axis_position_um(&axis, START + 1000000000));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, sim_axis_speed_um_us(&axis, START + 1000));
}

void test_a_motion_is_a_trapezoid_or_a_triangle(void)
{
    unsigned triangles = 0u;
    for (unsigned i = 0u; i < MOTIONS; ++i) {
        draw_motion();
        check_whole_motion();
        triangles += motion.decel_start < 1.001 * motion.accel_end ? 1u : 0u;
    }
    TEST_ASSERT_GREATER_THAN_UINT(MOTIONS / 20u, triangles);
    TEST_ASSERT_LESS_THAN_UINT(MOTIONS / 2u, triangles);
}

void test_before_a_motion_the_axis_is_where_it_begins(void)
{
    for (unsigned i = 0u; i < 100u; ++i) {
        draw_motion();
        TEST_ASSERT_DOUBLE_WITHIN(TINY_UM, 1000.0 * motion.from,
                                  sim_axis_position_um(&axis, START - 1000000));
    }
}

void test_the_axis_is_at_rest_by_its_standstill(void)
{
    for (unsigned i = 0u; i < MOTIONS; ++i) {
        draw_motion();
        double late_ns = (double)(sim_axis_standstill(&axis) - START) - end_s() * 1e9;
        TEST_ASSERT_TRUE(late_ns > -0.01 && late_ns <= 1.01);
    }
}

void test_the_speed_is_the_slope_of_the_position(void)
{
    for (unsigned i = 0u; i < MOTIONS; ++i) {
        draw_motion();
        double   share = dice_between(&dice, 0.01, 0.99);
        sim_ns_t now = ns_after_start(end_s() * share);
        sim_ns_t step = 100;
        double   slope =
            (sim_axis_position_um(&axis, now + step) - sim_axis_position_um(&axis, now - step)) /
            (2e-3 * (double)step);
        double change = motion.accel * 1e-9 * 1e-3 * (double)step * 4.0;
        TEST_ASSERT_DOUBLE_WITHIN(change + 1e-6, slope, sim_axis_speed_um_us(&axis, now));
    }
}

void test_at_both_ends_the_speed_is_zero(void)
{
    for (unsigned i = 0u; i < 100u; ++i) {
        draw_motion();
        double tick = motion.accel * 1e-11;
        TEST_ASSERT_DOUBLE_WITHIN(tick, 0.0, sim_axis_speed_um_us(&axis, START));
        TEST_ASSERT_EQUAL_DOUBLE(0.0, sim_axis_speed_um_us(&axis, START - 1000));
        TEST_ASSERT_DOUBLE_WITHIN(tick, 0.0,
                                  sim_axis_speed_um_us(&axis, sim_axis_standstill(&axis)));
        TEST_ASSERT_DOUBLE_WITHIN(tick, 0.0, sim_axis_speed_um_us(&axis, ns_after_start(9e3)));
    }
}

/* ---- towards the surface ---- */

void test_a_motion_towards_the_surface_has_its_speed_there(void)
{
    motion = (motion_t){.from = -1.0, .sense = 1.0, .accel = 2000.0};
    motion.speed = sqrt(2.0 * 2000.0 * 1.0); /* what 1 mm is good for */
    motion.accel_end = motion.speed / motion.accel;
    motion.decel_start = 21.0 / motion.speed;
    place_and_move(20.0, 1000.0);

    check_whole_motion();
}

void test_a_motion_that_ends_before_the_surface_may_go_faster(void)
{
    motion = (motion_t){.from = -1.0, .sense = -1.0, .accel = 2000.0};
    motion.speed = sqrt(2000.0 * 20.0);
    motion.accel_end = motion.speed / motion.accel;
    motion.decel_start = 20.0 / motion.speed;
    place_and_move(-21.0, 1000.0);

    check_whole_motion();
}

void test_a_motion_begins_where_the_last_one_is(void)
{
    draw_motion();
    sim_ns_t now = ns_after_start(0.3 * end_s());
    double   there_um = sim_axis_position_um(&axis, now);
    sim_axis_move(&axis, there_um - 5000.0, 600.0, now);

    TEST_ASSERT_DOUBLE_WITHIN(TINY_UM, there_um, sim_axis_position_um(&axis, now));
    TEST_ASSERT_DOUBLE_WITHIN(TINY_UM, there_um - 5000.0,
                              sim_axis_position_um(&axis, sim_axis_standstill(&axis)));
}

void test_a_motion_of_no_length_is_over_at_once(void)
{
    sim_axis_place(&axis, 3000.0, 10.0, START);
    sim_axis_move(&axis, 10.0, 600.0, START);

    TEST_ASSERT_TRUE(sim_axis_standstill(&axis) - START <= 1);
    TEST_ASSERT_EQUAL_DOUBLE(10.0, sim_axis_position_um(&axis, START + 1000));
}

/* ---- stopping ---- */

static void stop(double stop_s, double reaction_s)
{
    double brake_s = stop_s + reaction_s;
    sim_axis_stop(&axis, (sim_ns_t)llrint(reaction_s * 1e9), ns_after_start(stop_s));
    if (brake_s < motion.decel_start) {
        motion.accel_end = fmin(motion.accel_end, brake_s);
        motion.speed = motion.accel * motion.accel_end;
        motion.decel_start = brake_s;
    }
}

void test_a_stop_decelerates_after_its_reaction_wherever_it_comes(void)
{
    unsigned while_accelerating = 0u;
    unsigned too_late = 0u;
    for (unsigned i = 0u; i < MOTIONS; ++i) {
        draw_motion();
        double stop_s = rint(end_s() * dice_between(&dice, 0.0, 0.9) * 1e9) * 1e-9;
        double reaction_s = rint(end_s() * dice_between(&dice, 0.0, 0.3) * 1e9) * 1e-9;
        while_accelerating += stop_s + reaction_s < motion.accel_end ? 1u : 0u;
        too_late += stop_s + reaction_s > motion.decel_start ? 1u : 0u;
        stop(stop_s, reaction_s);
        check_whole_motion();
    }
    TEST_ASSERT_GREATER_THAN_UINT(MOTIONS / 20u, while_accelerating);
    TEST_ASSERT_GREATER_THAN_UINT(MOTIONS / 20u, too_late);
}

void test_a_second_stop_changes_nothing(void)
{
    for (unsigned i = 0u; i < 200u; ++i) {
        draw_motion();
        stop(0.2 * end_s(), 0.0);
        stop(0.3 * end_s(), 0.0);
        sim_ns_t standstill = sim_axis_standstill(&axis);
        sim_axis_stop(&axis, 0, standstill - 1);

        TEST_ASSERT_EQUAL_INT64(standstill, sim_axis_standstill(&axis));
        check_whole_motion();
    }
}

/* ---- the inverse ---- */

void test_the_crossing_of_a_position_is_the_time_it_is_there(void)
{
    for (unsigned i = 0u; i < MOTIONS; ++i) {
        draw_motion();
        if (dice_below(&dice, 2u) == 0u) {
            stop(end_s() * dice_between(&dice, 0.0, 0.9), 0.0);
        }
        double   time_s = end_s() * dice_between(&dice, 0.001, 0.999);
        sim_ns_t crossing = sim_axis_crossing(&axis, expected_um(time_s));
        TEST_ASSERT_NOT_EQUAL(SIM_NEVER, crossing);
        TEST_ASSERT_DOUBLE_WITHIN(TINY_UM + 2e-6 * motion.speed, expected_um(time_s),
                                  sim_axis_position_um(&axis, crossing));
    }
}

void test_a_position_out_of_the_way_is_never_crossed(void)
{
    for (unsigned i = 0u; i < MOTIONS; ++i) {
        draw_motion();
        double behind_um = 1000.0 * motion.from - motion.sense * 0.001;
        double beyond_um = expected_um(end_s()) + motion.sense * 0.001;
        TEST_ASSERT_EQUAL_INT64(SIM_NEVER, sim_axis_crossing(&axis, behind_um));
        TEST_ASSERT_EQUAL_INT64(SIM_NEVER, sim_axis_crossing(&axis, beyond_um));
    }
}

void test_the_place_where_a_motion_begins_is_crossed_at_once(void)
{
    draw_motion();

    TEST_ASSERT_EQUAL_INT64(START, sim_axis_crossing(&axis, axis.from_um));
}
