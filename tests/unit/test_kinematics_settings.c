/* The parameters of cycle 451: every limit from both sides, and every error by name. */
/* LINK: firmware/cycle/kinematics_settings.c */
#include <math.h>
#include <string.h>

#include "cycle/kinematics_settings.h"
#include "unity.h"

#define STEP 0.0001 /* what the document resolves */

/* Written down from the document a second time, apart from the table. */
typedef struct {
    uint16_t id;
    double   low;
    double   high;
    double   initial;
    bool     is_whole;
} expected_t;

static const expected_t DOCUMENT[] = {
    {406, 0, 3, 0, true},
    {407, 0.0001, 99.9999, 12.5, false},
    {320, 0, 99999.9999, 0, false},
    {408, 0, 99999.9999, 0, false},
    {253, 0, 99999.9999, 750, false},
    {380, 0, 360, 0, false},
    {411, -359.9999, 359.9999, -90, false},
    {412, -359.9999, 359.9999, 90, false},
    {413, -359.9999, 359.9999, 0, false},
    {414, 0, 12, 0, true},
    {415, -359.9999, 359.9999, -90, false},
    {416, -359.9999, 359.9999, 90, false},
    {417, -359.999, 360.000, 0, false},
    {418, 0, 12, 2, true},
    {419, -359.9999, 359.9999, -90, false},
    {420, -359.9999, 359.9999, 90, false},
    {421, -359.9999, 360.000, 0, false}, /* printed: 359.9999; a turn as for Q417 */
    {422, 0, 12, 2, true},
    {423, 3, 8, 4, true},
    {431, 0, 3, 0, true},
    {432, -3, 3, 0, false},
};
#define COUNT (sizeof DOCUMENT / sizeof *DOCUMENT)

static kinematics_settings_t settings;

void setUp(void)
{
    kinematics_settings_reset(&settings, KINEMATICS_MEASURE);
}

void tearDown(void)
{
}

static void check(uint16_t id, double value, kinematics_setting_error_t error)
{
    kinematics_setting_t  setting = kinematics_settings_find(id);
    kinematics_settings_t direct = settings;
    double                before = settings.value[setting];

    direct.value[setting] = value;

    TEST_ASSERT_EQUAL_MESSAGE(error, kinematics_settings_set(&settings, id, value), "set");
    TEST_ASSERT_EQUAL_MESSAGE(error, kinematics_settings_check(&direct, setting), "check");
    TEST_ASSERT_EQUAL(error == KINEMATICS_SETTING_OK ? KINEMATICS_SETTINGS : setting,
                      kinematics_settings_fault(&direct));
    if (error == KINEMATICS_SETTING_OK) {
        TEST_ASSERT_EQUAL_DOUBLE(value, settings.value[setting]);
    } else {
        TEST_ASSERT_EQUAL_DOUBLE(before, settings.value[setting]);
    }
}

void test_the_document_has_these_parameters_and_no_others(void)
{
    TEST_ASSERT_EQUAL(KINEMATICS_SETTINGS, COUNT);
    for (uint32_t i = 0u; i < COUNT; i++) {
        const kinematics_setting_description_t *row = kinematics_settings_describe(i);

        TEST_ASSERT_EQUAL(DOCUMENT[i].id, row->id);
        TEST_ASSERT_EQUAL(i, kinematics_settings_find(row->id));
        TEST_ASSERT_EQUAL(DOCUMENT[i].is_whole, row->is_whole);
        TEST_ASSERT_NOT_EQUAL(0, row->name[0]);
    }
    TEST_ASSERT_NULL(kinematics_settings_describe(COUNT));
    TEST_ASSERT_EQUAL(KINEMATICS_SETTINGS, kinematics_settings_find(0));
    TEST_ASSERT_EQUAL(KINEMATICS_SETTINGS, kinematics_settings_find(410));
}

void test_the_defaults_are_those_of_the_first_program_and_sound(void)
{
    for (uint32_t i = 0u; i < COUNT; i++) {
        TEST_ASSERT_EQUAL_DOUBLE(DOCUMENT[i].initial, settings.value[i]);
        TEST_ASSERT_EQUAL(KINEMATICS_NUMBER, settings.word[i]);
    }
    TEST_ASSERT_EQUAL(KINEMATICS_SETTINGS, kinematics_settings_fault(&settings));
}

void test_every_parameter_takes_its_limits_and_nothing_beyond(void)
{
    for (uint32_t i = 0u; i < COUNT; i++) {
        double step = DOCUMENT[i].is_whole ? 1.0 : STEP;

        check(DOCUMENT[i].id, DOCUMENT[i].low, KINEMATICS_SETTING_OK);
        check(DOCUMENT[i].id, DOCUMENT[i].low + step, KINEMATICS_SETTING_OK);
        check(DOCUMENT[i].id, DOCUMENT[i].high - step, KINEMATICS_SETTING_OK);
        check(DOCUMENT[i].id, DOCUMENT[i].high, KINEMATICS_SETTING_OK);
        check(DOCUMENT[i].id, DOCUMENT[i].low - step, KINEMATICS_SETTING_LOW);
        check(DOCUMENT[i].id, nextafter(DOCUMENT[i].low, -1e9), KINEMATICS_SETTING_LOW);
        check(DOCUMENT[i].id, DOCUMENT[i].high + step, KINEMATICS_SETTING_HIGH);
        check(DOCUMENT[i].id, nextafter(DOCUMENT[i].high, 1e9), KINEMATICS_SETTING_HIGH);
        check(DOCUMENT[i].id, -1e300, KINEMATICS_SETTING_LOW);
        check(DOCUMENT[i].id, 1e300, KINEMATICS_SETTING_HIGH);
    }
}

void test_every_parameter_refuses_what_is_no_number(void)
{
    for (uint32_t i = 0u; i < COUNT; i++) {
        check(DOCUMENT[i].id, NAN, KINEMATICS_SETTING_NOT_FINITE);
        check(DOCUMENT[i].id, INFINITY, KINEMATICS_SETTING_NOT_FINITE);
        check(DOCUMENT[i].id, -INFINITY, KINEMATICS_SETTING_NOT_FINITE);
    }
}

void test_numbers_of_things_and_modes_are_whole(void)
{
    for (uint32_t i = 0u; i < COUNT; i++) {
        double middle = DOCUMENT[i].high - 0.5;
        check(DOCUMENT[i].id, middle,
              DOCUMENT[i].is_whole ? KINEMATICS_SETTING_NOT_WHOLE : KINEMATICS_SETTING_OK);
    }
    for (int mode = 0; mode <= 3; mode++) {
        check(406, mode, KINEMATICS_SETTING_OK);
        check(431, mode, KINEMATICS_SETTING_OK);
    }
}

void test_words_stand_only_where_the_document_has_them(void)
{
    for (uint32_t i = 0u; i < COUNT; i++) {
        uint16_t id = DOCUMENT[i].id;
        bool     fmax = id == 253;
        bool     fauto = id == 253;
        bool     predef = id == 253 || id == 320;

        TEST_ASSERT_EQUAL(fmax ? KINEMATICS_SETTING_OK : KINEMATICS_SETTING_WORD,
                          kinematics_settings_set_word(&settings, id, KINEMATICS_FMAX));
        TEST_ASSERT_EQUAL(fauto ? KINEMATICS_SETTING_OK : KINEMATICS_SETTING_WORD,
                          kinematics_settings_set_word(&settings, id, KINEMATICS_FAUTO));
        TEST_ASSERT_EQUAL(predef ? KINEMATICS_SETTING_OK : KINEMATICS_SETTING_WORD,
                          kinematics_settings_set_word(&settings, id, KINEMATICS_PREDEF));
        TEST_ASSERT_EQUAL(KINEMATICS_SETTING_WORD,
                          kinematics_settings_set_word(&settings, id, KINEMATICS_NUMBER));
        TEST_ASSERT_EQUAL(predef ? KINEMATICS_PREDEF : KINEMATICS_NUMBER, settings.word[i]);
    }
    TEST_ASSERT_EQUAL(KINEMATICS_SETTINGS, kinematics_settings_fault(&settings));
}

void test_a_word_smuggled_in_is_found(void)
{
    settings.word[KINEMATICS_Q407_SPHERE_RADIUS] = KINEMATICS_FMAX;
    TEST_ASSERT_EQUAL(KINEMATICS_Q407_SPHERE_RADIUS, kinematics_settings_fault(&settings));

    settings.word[KINEMATICS_Q407_SPHERE_RADIUS] = KINEMATICS_NUMBER;
    settings.word[KINEMATICS_Q253_FEED] = (kinematics_word_t)(KINEMATICS_FMAX | KINEMATICS_FAUTO);
    TEST_ASSERT_EQUAL(KINEMATICS_Q253_FEED, kinematics_settings_fault(&settings));
}

void test_a_number_takes_the_place_of_a_word(void)
{
    TEST_ASSERT_EQUAL(KINEMATICS_SETTING_OK,
                      kinematics_settings_set_word(&settings, 253, KINEMATICS_FMAX));
    TEST_ASSERT_EQUAL(KINEMATICS_SETTING_OK, kinematics_settings_set(&settings, 253, 500.0));

    TEST_ASSERT_EQUAL(KINEMATICS_NUMBER, settings.word[KINEMATICS_Q253_FEED]);
    TEST_ASSERT_EQUAL_DOUBLE(500.0, settings.value[KINEMATICS_Q253_FEED]);
}

void test_a_number_the_cycle_has_not_is_unknown(void)
{
    TEST_ASSERT_EQUAL(KINEMATICS_SETTING_UNKNOWN, kinematics_settings_set(&settings, 409, 1.0));
    TEST_ASSERT_EQUAL(KINEMATICS_SETTING_UNKNOWN,
                      kinematics_settings_set_word(&settings, 409, KINEMATICS_FMAX));
    TEST_ASSERT_EQUAL(KINEMATICS_SETTING_UNKNOWN,
                      kinematics_settings_check(&settings, KINEMATICS_SETTINGS));
}

void test_every_error_has_its_own_phrase(void)
{
    for (int i = KINEMATICS_SETTING_OK; i <= KINEMATICS_SETTING_WORD; i++) {
        for (int j = KINEMATICS_SETTING_OK; j < i; j++) {
            TEST_ASSERT_NOT_EQUAL(
                0, strcmp(kinematics_settings_phrase((kinematics_setting_error_t)i),
                          kinematics_settings_phrase((kinematics_setting_error_t)j)));
        }
    }
}
