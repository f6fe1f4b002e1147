/* The simulated five-axis machine: chains, play, and where the ball meets the sphere. */
/* LINK: host_sim/five_axis.c */
#include <math.h>
#include <unity.h>

#include "five_axis.h"

#define NM 1.0e-6 /* mm */

static sim_machine_t machine;
static sim_stance_t  stance;

void setUp(void)
{
    machine = (sim_machine_t){
        .axes = {{.direction = {1.0, 0.0, 0.0}},
                 {.direction = {0.0, 1.0, 0.0}},
                 {.direction = {0.0, 0.0, 1.0}}},
        .table = {SIM_ROTARY_A, SIM_ROTARY_C, -1},
        .head = {-1, -1, -1},
        .sphere_mm = {100.0, 0.0, 50.0},
        .sphere_radius_mm = 12.0,
        .tip_radius_mm = 3.0,
    };
    sim_machine_home(&machine, &stance);
}

void tearDown(void)
{
}

static void assert_vector(double x, double y, double z, const double *actual)
{
    TEST_ASSERT_DOUBLE_WITHIN(NM, x, actual[0]);
    TEST_ASSERT_DOUBLE_WITHIN(NM, y, actual[1]);
    TEST_ASSERT_DOUBLE_WITHIN(NM, z, actual[2]);
}

void test_the_outer_axis_of_a_table_is_carried_by_the_inner_one(void)
{
    double centre_mm[3];
    sim_machine_turn(&machine, &stance, SIM_ROTARY_C, 90.0, 0.0);
    sim_machine_turn(&machine, &stance, SIM_ROTARY_A, 90.0, 0.0);

    sim_machine_sphere(&machine, &stance, centre_mm);

    assert_vector(0.0, -50.0, 100.0, centre_mm);
}

void test_a_head_swings_the_tip_and_turns_the_probe(void)
{
    const double reading_mm[3] = {10.0, 20.0, 30.0};
    const double up[3] = {0.0, 0.0, 1.0};
    double       tip_mm[3];
    double       axis[3];
    machine.table[0] = machine.table[1] = -1;
    machine.head[0] = SIM_ROTARY_B;
    machine.axes[SIM_ROTARY_B].point_mm[2] = 200.0;
    sim_machine_tip(&machine, &stance, reading_mm, tip_mm);
    assert_vector(10.0, 20.0, 30.0, tip_mm);

    sim_machine_turn(&machine, &stance, SIM_ROTARY_B, 90.0, 0.0);
    sim_machine_tip(&machine, &stance, reading_mm, tip_mm);
    sim_machine_probe_direction(&machine, &stance, up, axis);

    assert_vector(10.0 - 200.0, 20.0, 30.0 + 200.0, tip_mm);
    assert_vector(1.0, 0.0, 0.0, axis);
}

void test_the_load_follows_only_once_the_play_is_used_up(void)
{
    const double told_deg[] = {10.0, 9.9, 9.8, 9.7, 9.75, 9.95, 10.5};
    const double load_deg[] = {10.0, 10.0, 10.0, 9.9, 9.9, 9.95, 10.5};
    machine.axes[SIM_ROTARY_C].backlash_deg = 0.2;
    for (unsigned i = 0; i < sizeof told_deg / sizeof told_deg[0]; ++i) {
        sim_machine_turn(&machine, &stance, SIM_ROTARY_C, told_deg[i], 0.0);

        TEST_ASSERT_DOUBLE_WITHIN(1e-9, load_deg[i], stance.load_deg[SIM_ROTARY_C]);
    }
}

void test_a_full_turn_comes_back_to_the_same_place(void)
{
    double before_mm[3];
    double after_mm[3];
    sim_machine_turn(&machine, &stance, SIM_ROTARY_C, -90.0, 0.0);
    sim_machine_sphere(&machine, &stance, before_mm);

    sim_machine_turn(&machine, &stance, SIM_ROTARY_C, 270.0, 0.0);
    sim_machine_sphere(&machine, &stance, after_mm);

    assert_vector(before_mm[0], before_mm[1], before_mm[2], after_mm);
}

void test_the_ball_meets_the_sphere_where_their_radii_meet(void)
{
    const double above_mm[3] = {100.0, 0.0, 80.0};
    const double beside_mm[3] = {100.0, 9.0, 80.0};
    const double down[3] = {0.0, 0.0, -1.0};

    double centred = sim_machine_distance_mm(&machine, &stance, above_mm, down);
    double off_centre = sim_machine_distance_mm(&machine, &stance, beside_mm, down);

    TEST_ASSERT_DOUBLE_WITHIN(NM, 15.0, centred);
    TEST_ASSERT_DOUBLE_WITHIN(NM, 30.0 - 12.0, off_centre); /* 9, 12, 15 */
}

void test_a_ball_that_passes_by_meets_nothing_and_one_within_has_met(void)
{
    const double down[3] = {0.0, 0.0, -1.0};
    const double grazing_mm[3] = {100.0, 14.999, 80.0};
    const double by_mm[3] = {100.0, 15.001, 80.0};
    const double within_mm[3] = {100.0, 0.0, 60.0};

    TEST_ASSERT_TRUE(sim_machine_distance_mm(&machine, &stance, grazing_mm, down) > 0.0);
    TEST_ASSERT_TRUE(isnan(sim_machine_distance_mm(&machine, &stance, by_mm, down)));
    TEST_ASSERT_TRUE(sim_machine_distance_mm(&machine, &stance, within_mm, down) < 0.0);
}

void test_a_location_error_moves_and_tilts_the_line(void)
{
    double centre_mm[3];
    machine.axes[SIM_ROTARY_C].offset_mm[0] = 0.5;
    machine.axes[SIM_ROTARY_C].tilt_rad[1] = 1.0e-3;
    sim_machine_turn(&machine, &stance, SIM_ROTARY_C, 180.0, 0.0);

    sim_machine_sphere(&machine, &stance, centre_mm);

    /* Half a turn mirrors at the line through (0.5, 0, 0) along (sin, 0, cos) of 1 mrad. */
    double s = sin(2.0e-3);
    double c = cos(2.0e-3);
    assert_vector(0.5 - c * 99.5 + s * 50.0, 0.0, s * 99.5 + c * 50.0, centre_mm);
}

/* ---- what cannot be played ---- */

static void refuse(void)
{
    TEST_ASSERT_FALSE(sim_machine_is_sound(&machine));
    setUp();
    TEST_ASSERT_TRUE(sim_machine_is_sound(&machine));
}

void test_lists_name_axes_that_there_are_and_each_once(void)
{
    machine.table[0] = SIM_ROTARIES;
    refuse();
    machine.head[2] = -2;
    refuse();
    machine.head[0] = SIM_ROTARY_C;
    refuse();
    machine.table[0] = machine.table[1] = -1;
    refuse();
}

void test_a_machine_is_of_finite_numbers_and_true_lengths(void)
{
    machine.axes[1].direction[1] = 1.001;
    refuse();
    machine.axes[0].point_mm[2] = NAN;
    refuse();
    machine.axes[2].backlash_deg = -1e-9;
    refuse();
    machine.axes[2].datum_deg = INFINITY;
    refuse();
    machine.sphere_mm[1] = NAN;
    refuse();
    machine.sphere_radius_mm = 0.0;
    refuse();
    machine.tip_radius_mm = -1.0;
    refuse();
}
