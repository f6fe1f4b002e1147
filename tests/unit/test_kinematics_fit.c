/* Location errors of rotary axes: values, what is undetermined, and what is refused. */
/* LINK: firmware/comp/kinematics*.c */
#include <math.h>
#include <string.h>

#include "comp/kinematics.h"
#include "unity.h"

#define RAD_PER_DEG 0.017453292519943295
#define MAX         128

static kinematics_machine_t machine;
static kinematics_point_t   points[MAX];
static kinematics_result_t  result;

static void set_axis(int32_t j, char letter, int32_t is_head)
{
    kinematics_axis_t *axis = &machine.axes[j];
    memset(axis, 0, sizeof *axis);
    axis->letter = letter;
    axis->is_head = is_head;
    axis->direction[letter - 'A'] = 1.0;
}

void setUp(void)
{
    memset(&machine, 0, sizeof machine);
    memset(points, 0, sizeof points);
    machine.axes_count = 1;
    set_axis(0, 'C', 0);
}

void tearDown(void)
{
}

static void turn(double *x, double *y, double angle_deg)
{
    double c = cos(angle_deg * RAD_PER_DEG);
    double s = sin(angle_deg * RAD_PER_DEG);
    double old = *x;
    *x = c * old - s * *y;
    *y = s * old + c * *y;
}

/* A sphere at (100, 20, 30) on a C table whose axis stands at (x, y) and is parallel to Z. */
static void play_c(int32_t n, double step_deg, double x, double y)
{
    for (int32_t i = 0; i < n; i++) {
        double *p = points[i].position_mm;
        double  at[3] = {100.0 - x, 20.0 - y, 30.0};
        points[i].angle_deg[0] = step_deg * (double)i;
        turn(&at[0], &at[1], points[i].angle_deg[0]);
        p[0] = x + at[0];
        p[1] = y + at[1];
        p[2] = at[2];
    }
}

/* A tilts about X through the origin, C turns about Z through the origin, on it. */
static int32_t play_ac(void)
{
    int32_t n = 0;
    machine.axes_count = 2;
    set_axis(0, 'A', 0);
    set_axis(1, 'C', 0);
    for (double a = -90.0; a < 91.0; a += 45.0) {
        for (double c = 0.0; c < 359.0; c += 60.0) {
            double at[3] = {120.0, 10.0, 40.0};
            turn(&at[0], &at[1], c);
            turn(&at[1], &at[2], a);
            points[n].angle_deg[0] = a;
            points[n].angle_deg[1] = c;
            memcpy(points[n++].position_mm, at, sizeof at);
        }
    }
    return n;
}

static int32_t index_of(const char *name)
{
    int32_t found = -1;
    for (int32_t i = 0; i < result.parameters_count; i++) {
        found = strcmp(result.parameters[i].name, name) == 0 ? i : found;
    }
    TEST_ASSERT_TRUE_MESSAGE(found >= 0, name);
    return found;
}

static const kinematics_parameter_t *parameter(const char *name)
{
    return &result.parameters[index_of(name)];
}

static const kinematics_blind_t *blind(const char *name)
{
    const kinematics_blind_t *found = NULL;
    for (int32_t b = 0; b < result.blind_count; b++) {
        found = result.blind[b].parameter == index_of(name) ? &result.blind[b] : found;
    }
    TEST_ASSERT_NOT_NULL_MESSAGE(found, name);
    return found;
}

void test_an_offset_is_actual_minus_believed(void)
{
    machine.axes[0].point_mm[0] = 1.0;
    machine.axes[0].point_mm[1] = 2.0;
    play_c(4, 90.0, 1.25, 1.9);

    TEST_ASSERT_EQUAL(KINEMATICS_OK, kinematics_fit(&machine, points, 4, &result));

    TEST_ASSERT_EQUAL(KINEMATICS_DETERMINED, parameter("XOC")->state);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 250.0, parameter("XOC")->value);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, -100.0, parameter("YOC")->value);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, parameter("AOC")->value);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 100.0, result.sphere_mm[0]);
}

/* A turn of the line by +α about X takes its +Z end to −Y: what lies at +Y rises. */
void test_a_tilt_is_a_right_handed_turn(void)
{
    const double alpha_rad = 1e-4;
    play_c(6, 60.0, 0.0, 0.0);
    for (int i = 0; i < 6; i++) {
        double *p = points[i].position_mm;
        double  y = p[1];
        double  z = p[2];
        p[1] = cos(alpha_rad) * y - sin(alpha_rad) * z;
        p[2] = sin(alpha_rad) * y + cos(alpha_rad) * z;
    }

    TEST_ASSERT_EQUAL(KINEMATICS_OK, kinematics_fit(&machine, points, 6, &result));

    TEST_ASSERT_DOUBLE_WITHIN(1e-4, alpha_rad / RAD_PER_DEG * 3600.0, parameter("AOC")->value);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.0, parameter("BOC")->value);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.0, parameter("XOC")->value);
}

void test_tilting_and_turning_table_have_13_unknowns_and_rank_11(void)
{
    int32_t n = play_ac();

    TEST_ASSERT_EQUAL(KINEMATICS_OK, kinematics_fit(&machine, points, n, &result));

    TEST_ASSERT_EQUAL(13, result.unknowns);
    TEST_ASSERT_EQUAL(11, result.rank);
    TEST_ASSERT_EQUAL(2, result.blind_count);
    TEST_ASSERT_EQUAL(1, blind("COC")->with_sphere);
    TEST_ASSERT_EQUAL(0, blind("COC")->named[index_of("AOC")]);
    TEST_ASSERT_EQUAL(1, blind("AOA")->named[index_of("AOC")]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, -1.0, blind("AOA")->per_unit[index_of("AOC")]);
}

void test_an_axis_that_never_turns_is_undetermined(void)
{
    play_ac();

    TEST_ASSERT_EQUAL(KINEMATICS_OK, kinematics_fit(&machine, &points[12], 6, &result));

    TEST_ASSERT_EQUAL(KINEMATICS_UNDETERMINED, parameter("YOA")->state);
    TEST_ASSERT_EQUAL(KINEMATICS_UNDETERMINED, parameter("COA")->state);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, parameter("YOA")->value);
    TEST_ASSERT_EQUAL(0, blind("YOA")->with_sphere);
    TEST_ASSERT_EQUAL(KINEMATICS_DETERMINED, parameter("AOC")->state);
}

/* Tilted for good, an axis cannot be told from the one that it carries. */
void test_an_axis_that_stands_tilted_goes_with_the_one_it_carries(void)
{
    play_ac();

    TEST_ASSERT_EQUAL(KINEMATICS_OK, kinematics_fit(&machine, points, 6, &result));

    TEST_ASSERT_EQUAL(7, result.rank);
    TEST_ASSERT_NOT_EQUAL(KINEMATICS_DETERMINED, parameter("YOA")->state);
    TEST_ASSERT_NOT_EQUAL(KINEMATICS_DETERMINED, parameter("YOC")->state);
    TEST_ASSERT_EQUAL(KINEMATICS_DETERMINED, parameter("XOC")->state);
}

void test_a_sphere_on_the_axis_leaves_tilt_and_offset_together(void)
{
    for (int i = 0; i < 4; i++) {
        points[i].angle_deg[0] = 90.0 * i;
        points[i].position_mm[2] = 50.0;
    }

    TEST_ASSERT_EQUAL(KINEMATICS_OK, kinematics_fit(&machine, points, 4, &result));

    TEST_ASSERT_NOT_EQUAL(KINEMATICS_DETERMINED, parameter("AOC")->state);
    TEST_ASSERT_NOT_EQUAL(KINEMATICS_DETERMINED, parameter("YOC")->state);
}

/* A head at pivot height 200 over the tip; B turns about Y. */
static void play_head(void)
{
    set_axis(0, 'B', 1);
    machine.axes[0].point_mm[2] = 200.0;
    for (int i = 0; i < 7; i++) {
        double tip[3] = {0.0, 0.0, -200.5}; /* the pivot is 0.5 mm higher than believed */
        points[i].angle_deg[0] = 30.0 * i - 90.0;
        turn(&tip[2], &tip[0], points[i].angle_deg[0]);
        points[i].position_mm[0] = 10.0 - tip[0];
        points[i].position_mm[1] = 11.0;
        points[i].position_mm[2] = 12.0 - (tip[2] + 200.5);
    }
}

void test_a_pivot_cannot_be_told_from_the_length_of_the_tool(void)
{
    play_head();

    TEST_ASSERT_EQUAL(KINEMATICS_OK, kinematics_fit(&machine, points, 7, &result));

    TEST_ASSERT_EQUAL(KINEMATICS_UNDETERMINED, parameter("XOB")->state);
    TEST_ASSERT_EQUAL(KINEMATICS_UNDETERMINED, parameter("ZOB")->state);
    TEST_ASSERT_EQUAL(1, blind("ZOB")->with_tip);
    TEST_ASSERT_EQUAL(KINEMATICS_DETERMINED, parameter("AOB")->state);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.0, parameter("AOB")->value);
}

void test_with_a_known_tip_the_pivot_is_determined(void)
{
    play_head();
    machine.tool_is_known = 1;

    TEST_ASSERT_EQUAL(KINEMATICS_OK, kinematics_fit(&machine, points, 7, &result));

    TEST_ASSERT_EQUAL(KINEMATICS_DETERMINED, parameter("ZOB")->state);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 500.0, parameter("ZOB")->value);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, parameter("XOB")->value);
}

void test_as_many_coordinates_as_unknowns_are_too_few(void)
{
    play_c(2, 90.0, 0.0, 0.0);
    TEST_ASSERT_EQUAL(KINEMATICS_ERR_TOO_FEW, kinematics_fit(&machine, points, 2, &result));
    TEST_ASSERT_EQUAL(KINEMATICS_ERR_TOO_FEW, kinematics_fit(&machine, points, 0, &result));

    play_c(3, 90.0, 0.0, 0.0);
    TEST_ASSERT_EQUAL(KINEMATICS_OK, kinematics_fit(&machine, points, 3, &result));
    TEST_ASSERT_EQUAL(2, result.freedom);
}

void test_points_of_another_machine_do_not_fit(void)
{
    play_c(4, 90.0, 5000.0, 0.0);

    TEST_ASSERT_EQUAL(KINEMATICS_ERR_NO_FIT, kinematics_fit(&machine, points, 4, &result));
}

void test_what_is_not_finite_is_refused(void)
{
    play_c(4, 90.0, 0.0, 0.0);
    points[3].position_mm[2] = NAN;
    TEST_ASSERT_EQUAL(KINEMATICS_ERR_POINT, kinematics_fit(&machine, points, 4, &result));

    play_c(4, 90.0, 0.0, 0.0);
    points[0].angle_deg[0] = INFINITY;
    TEST_ASSERT_EQUAL(KINEMATICS_ERR_POINT, kinematics_fit(&machine, points, 4, &result));
}

static void refuse_machine(void)
{
    TEST_ASSERT_EQUAL(KINEMATICS_ERR_MACHINE, kinematics_fit(&machine, points, 4, &result));
    setUp();
    play_c(4, 90.0, 0.0, 0.0);
}

void test_a_machine_that_is_none_is_refused(void)
{
    play_c(4, 90.0, 0.0, 0.0);
    machine.axes_count = 0;
    refuse_machine();
    machine.axes_count = KINEMATICS_AXES_MAX + 1;
    refuse_machine();
    machine.axes[0].letter = 'D';
    refuse_machine();
    machine.axes_count = 2;
    set_axis(1, 'C', 0);
    refuse_machine();
    machine.axes[0].direction[2] = 1.001;
    refuse_machine();
    machine.axes[0].direction[2] = 0.0;
    machine.axes[0].direction[0] = 1.0;
    refuse_machine();
    machine.axes[0].point_mm[1] = NAN;
    refuse_machine();
    machine.tool_is_known = 1;
    machine.tool_mm[0] = INFINITY;
    refuse_machine();

    TEST_ASSERT_EQUAL(KINEMATICS_OK, kinematics_fit(&machine, points, 4, &result));
}

/* Only C was turned; both axes together have to be, before all is determined. */
void test_recommended_positions_determine_what_was_not(void)
{
    const kinematics_travel_t travel = {.low_deg = {-30.0, -180.0}, .high_deg = {90.0, 180.0}};
    kinematics_point_t        more[24];
    play_ac();

    int32_t found = kinematics_recommend(&machine, &points[12], 6, &travel, 24, more, &result);

    TEST_ASSERT_GREATER_THAN(0, found);
    TEST_ASSERT_EQUAL(11, result.rank);
    TEST_ASSERT_EQUAL(KINEMATICS_DETERMINED, parameter("YOA")->state);
    for (int i = 0; i < found; i++) {
        TEST_ASSERT_TRUE(more[i].angle_deg[0] >= -30.0 && more[i].angle_deg[0] <= 90.0);
    }
}

static double farthest_deg(double low_deg, double high_deg)
{
    const kinematics_travel_t travel = {.low_deg = {low_deg}, .high_deg = {high_deg}};
    kinematics_point_t        more[24];
    double                    farthest = 0.0;
    play_c(1, 0.0, 0.0, 0.0);
    int32_t found = kinematics_recommend(&machine, points, 1, &travel, 24, more, &result);
    TEST_ASSERT_GREATER_THAN(2, found);
    for (int i = 0; i < found; i++) {
        TEST_ASSERT_TRUE(more[i].angle_deg[0] >= low_deg && more[i].angle_deg[0] <= high_deg);
        farthest = fmax(farthest, fabs(more[i].angle_deg[0]));
    }
    return farthest;
}

void test_a_travel_of_several_turns_is_used_about_0(void)
{
    TEST_ASSERT_TRUE(farthest_deg(-720.0, 720.0) <= 180.0);
    TEST_ASSERT_TRUE(farthest_deg(0.0, 3600.0) <= 360.0);
    TEST_ASSERT_TRUE(farthest_deg(-3600.0, 0.0) <= 360.0);
    TEST_ASSERT_TRUE(farthest_deg(1000.0, 1300.0) >= 1000.0);
}

void test_a_travel_that_is_none_is_refused(void)
{
    const kinematics_travel_t turned = {.low_deg = {10.0}, .high_deg = {-10.0}};
    const kinematics_travel_t endless = {.low_deg = {0.0}, .high_deg = {INFINITY}};
    const kinematics_travel_t none = {.low_deg = {NAN}, .high_deg = {10.0}};
    kinematics_point_t        more[2];
    play_c(1, 0.0, 0.0, 0.0);

    TEST_ASSERT_EQUAL(KINEMATICS_ERR_MACHINE,
                      kinematics_recommend(&machine, points, 1, &turned, 2, more, &result));
    TEST_ASSERT_EQUAL(KINEMATICS_ERR_MACHINE,
                      kinematics_recommend(&machine, points, 1, &endless, 2, more, &result));
    TEST_ASSERT_EQUAL(KINEMATICS_ERR_MACHINE,
                      kinematics_recommend(&machine, points, 1, &none, 2, more, &result));
}

void test_enough_positions_need_no_more(void)
{
    const kinematics_travel_t travel = {.low_deg = {-90.0, -180.0}, .high_deg = {90.0, 180.0}};
    kinematics_point_t        more[24];
    int32_t                   n = play_ac();

    TEST_ASSERT_EQUAL(0, kinematics_recommend(&machine, points, n, &travel, 24, more, &result));
}

void test_no_positions_help_a_sphere_on_the_axis(void)
{
    const kinematics_travel_t travel = {.low_deg = {-180.0}, .high_deg = {180.0}};
    kinematics_point_t        more[24];
    points[0].position_mm[2] = 50.0;

    TEST_ASSERT_GREATER_THAN(0,
                             kinematics_recommend(&machine, points, 1, &travel, 24, more, &result));

    TEST_ASSERT_NOT_EQUAL(KINEMATICS_DETERMINED, parameter("AOC")->state);
    TEST_ASSERT_EQUAL(KINEMATICS_ERR_TOO_FEW,
                      kinematics_recommend(&machine, points, 0, &travel, 24, more, &result));
}

/* ---- absurd input ---- */

static void check_finite(const char *what)
{
    TEST_ASSERT_TRUE_MESSAGE(isfinite(result.residual_um), what);
    for (int32_t i = 0; i < result.parameters_count; i++) {
        TEST_ASSERT_TRUE_MESSAGE(isfinite(result.parameters[i].value), what);
        TEST_ASSERT_TRUE_MESSAGE(isfinite(result.parameters[i].uncertainty), what);
    }
    for (int32_t k = 0; k < 3; k++) {
        TEST_ASSERT_TRUE_MESSAGE(isfinite(result.sphere_mm[k]) && isfinite(result.tip_mm[k]), what);
    }
}

static uint32_t random_below(uint32_t limit)
{
    static uint32_t state = 1u;
    state = state * 1664525u + 1013904223u;
    return (state >> 16) % limit;
}

static double sane_or_absurd(void)
{
    static const double absurd[] = {1e-300, 1e9, 1e155, 1e200, 1.7e308, -1e200, -1e6};
    return random_below(6u) != 0u ? (double)random_below(300u) : absurd[random_below(7u)];
}

static void make_up_a_machine(void)
{
    setUp();
    machine.axes_count = 1 + (int32_t)random_below(2u);
    set_axis(0, 'A', (int32_t)random_below(2u));
    set_axis(1, 'C', (int32_t)random_below(2u));
    machine.tool_is_known = (int32_t)random_below(2u);
    machine.axial_scatter = random_below(3u) != 0u ? 1.0 : fabs(sane_or_absurd());
    for (int32_t k = 0; k < 3; k++) {
        machine.tool_mm[k] = sane_or_absurd();
        machine.axes[0].point_mm[k] = sane_or_absurd();
    }
    for (int32_t i = 0; i < 8; i++) {
        for (int32_t k = 0; k < 3; k++) {
            points[i].angle_deg[k] = (double)random_below(360u);
            points[i].position_mm[k] = sane_or_absurd();
        }
    }
}

/* Numbers that no machine has, but a file may: their squares are none. */
void test_what_is_found_is_finite_whatever_is_given(void)
{
    for (int32_t i = 0; i < 3000; i++) {
        make_up_a_machine();
        if (kinematics_fit(&machine, points, 4 + i % 5, &result) == KINEMATICS_OK) {
            check_finite("not finite");
        }
    }
}
