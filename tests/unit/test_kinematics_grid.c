/* The grid of cycle 453: its positions, and what a table has between them. */
/* LINK: firmware/comp/kinematics_grid.c */
#include <math.h>
#include <string.h>

#include "comp/kinematics_grid.h"
#include "unity.h"

static kinematics_grid_t grid;
static double            table_mm[KINEMATICS_GRID_POSITIONS_MAX][3];
static double            found_mm[3];

/* A at -30, 0 and 60, C at -180, -90, 0, 90 and 180. */
void setUp(void)
{
    grid = (kinematics_grid_t){
        .count = {3u, 0u, 5u},
        .node_deg = {{-30.0, 0.0, 60.0}, {0.0}, {-180.0, -90.0, 0.0, 90.0, 180.0}},
    };
    memset(table_mm, 0, sizeof table_mm);
    for (uint8_t i = 0u; i < kinematics_grid_positions(&grid); i++) {
        double angle_deg[3];
        kinematics_grid_angles(&grid, i, angle_deg);
        table_mm[i][0] = angle_deg[0] + 2.0 * fabs(angle_deg[2]);
        table_mm[i][1] = angle_deg[0] * fabs(angle_deg[2]);
        table_mm[i][2] = 7.0;
    }
}

void tearDown(void)
{
}

static void look(double a_deg, double c_deg)
{
    const double angle_deg[3] = {a_deg, 45.0, c_deg};
    kinematics_grid_interpolate(&grid, table_mm[0], angle_deg, found_mm);
}

void test_its_positions_go_through_c_first(void)
{
    double angle_deg[3];

    kinematics_grid_angles(&grid, 6u, angle_deg);

    TEST_ASSERT_EQUAL_UINT8(15u, kinematics_grid_positions(&grid));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, angle_deg[0]);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, angle_deg[1]);
    TEST_ASSERT_EQUAL_DOUBLE(-90.0, angle_deg[2]);
}

void test_its_reference_has_every_axis_at_0(void)
{
    TEST_ASSERT_EQUAL_UINT8(7u, kinematics_grid_reference(&grid));
}

void test_a_node_has_its_own_value(void)
{
    look(60.0, -90.0);

    TEST_ASSERT_EQUAL_DOUBLE(240.0, found_mm[0]);
    TEST_ASSERT_EQUAL_DOUBLE(5400.0, found_mm[1]);
    TEST_ASSERT_EQUAL_DOUBLE(7.0, found_mm[2]);
}

void test_between_nodes_it_is_linear_in_each_axis(void)
{
    look(-10.0, 30.0);

    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 50.0, found_mm[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, -300.0, found_mm[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 7.0, found_mm[2]);
}

void test_beyond_its_nodes_it_has_the_nearest(void)
{
    look(90.0, 0.0);
    TEST_ASSERT_EQUAL_DOUBLE(60.0, found_mm[0]);

    look(-31.0, 0.0);
    TEST_ASSERT_EQUAL_DOUBLE(-30.0, found_mm[0]);
}

void test_a_full_turn_changes_nothing(void)
{
    look(0.0, 270.0);
    TEST_ASSERT_EQUAL_DOUBLE(180.0, found_mm[0]);

    look(0.0, -450.0);
    TEST_ASSERT_EQUAL_DOUBLE(180.0, found_mm[0]);
}

void test_either_end_of_a_full_turn_has_its_own_value(void)
{
    table_mm[5][0] = -4.0;
    table_mm[9][0] = 4.0;

    look(0.0, -180.0);
    TEST_ASSERT_EQUAL_DOUBLE(-4.0, found_mm[0]);

    look(0.0, 180.0);
    TEST_ASSERT_EQUAL_DOUBLE(4.0, found_mm[0]);
}

void test_a_sound_grid_has_2_to_75_positions(void)
{
    TEST_ASSERT_TRUE(kinematics_grid_is_sound(&grid));
    grid.count[1] = 5u;
    for (int i = 0; i < 6; i++) {
        grid.node_deg[1][i] = i;
    }
    TEST_ASSERT_TRUE(kinematics_grid_is_sound(&grid));
    grid.count[1] = 6u;
    TEST_ASSERT_FALSE(kinematics_grid_is_sound(&grid));
}

void test_a_grid_without_a_second_position_is_none(void)
{
    grid = (kinematics_grid_t){.count = {0u, 0u, 1u}};
    TEST_ASSERT_FALSE(kinematics_grid_is_sound(&grid));

    grid.count[2] = 2u;
    grid.node_deg[2][1] = 10.0;
    TEST_ASSERT_TRUE(kinematics_grid_is_sound(&grid));
}

static void check_unsound(uint8_t node, double value_deg)
{
    setUp();
    grid.node_deg[2][node] = value_deg;
    TEST_ASSERT_FALSE(kinematics_grid_is_sound(&grid));
}

void test_nodes_rise_within_a_turn_and_have_0(void)
{
    check_unsound(1u, -180.0);
    check_unsound(2u, 0.001);
    check_unsound(3u, 0.0);
    check_unsound(4u, 180.001);
    check_unsound(0u, (double)NAN);
    check_unsound(3u, (double)NAN);
    check_unsound(4u, (double)INFINITY);
}

void test_an_axis_has_25_nodes_at_most(void)
{
    grid = (kinematics_grid_t){.count = {0u, 0u, 25u}};
    for (int i = 0; i < 25; i++) {
        grid.node_deg[2][i] = i;
    }
    TEST_ASSERT_TRUE(kinematics_grid_is_sound(&grid));
    grid.count[2] = 26u;
    TEST_ASSERT_FALSE(kinematics_grid_is_sound(&grid));
}
