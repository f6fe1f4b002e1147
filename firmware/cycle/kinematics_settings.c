#include "cycle/kinematics_settings.h"

#include <math.h>
#include <stddef.h>

#define ANY   false
#define WHOLE true

#define TURN 359.9999 /* the largest angle of the document */
#define FEED (KINEMATICS_FMAX | KINEMATICS_FAUTO | KINEMATICS_PREDEF)

static const kinematics_setting_description_t TABLE[KINEMATICS_SETTINGS] = {
    {406u, WHOLE, 0u, "MODE", "", 0.0, 3.0, 0.0},
    {407u, ANY, 0u, "SPHERE RADIUS", "mm", 0.0001, 99.9999, 12.5},
    {320u, ANY, KINEMATICS_PREDEF, "SET-UP CLEARANCE", "mm", 0.0, 99999.9999, 0.0},
    {408u, ANY, 0u, "RETR. HEIGHT", "mm", 0.0, 99999.9999, 0.0},
    {253u, ANY, FEED, "F PRE-POSITIONING", "mm/min", 0.0, 99999.9999, 750.0},
    {380u, ANY, 0u, "REFERENCE ANGLE", "deg", 0.0, 360.0, 0.0},
    {411u, ANY, 0u, "START ANGLE A AXIS", "deg", -TURN, TURN, -90.0},
    {412u, ANY, 0u, "END ANGLE A AXIS", "deg", -TURN, TURN, 90.0},
    {413u, ANY, 0u, "INCID. ANGLE A AXIS", "deg", -TURN, TURN, 0.0},
    {414u, WHOLE, 0u, "MEAS. POINTS A AXIS", "", 0.0, 12.0, 0.0},
    {415u, ANY, 0u, "START ANGLE B AXIS", "deg", -TURN, TURN, -90.0},
    {416u, ANY, 0u, "END ANGLE B AXIS", "deg", -TURN, TURN, 90.0},
    {417u, ANY, 0u, "INCID. ANGLE B AXIS", "deg", -359.999, 360.0, 0.0},
    {418u, WHOLE, 0u, "MEAS. POINTS B AXIS", "", 0.0, 12.0, 2.0},
    {419u, ANY, 0u, "START ANGLE C AXIS", "deg", -TURN, TURN, -90.0},
    {420u, ANY, 0u, "END ANGLE C AXIS", "deg", -TURN, TURN, 90.0},
    {421u, ANY, 0u, "INCID. ANGLE C AXIS", "deg", -TURN, 360.0, 0.0},
    {422u, WHOLE, 0u, "MEAS. POINTS C AXIS", "", 0.0, 12.0, 2.0},
    {423u, WHOLE, 0u, "NO. OF PROBE POINTS", "", 3.0, 8.0, 4.0},
    {431u, WHOLE, 0u, "PRESET", "", 0.0, 3.0, 0.0},
    {432u, ANY, 0u, "BACKLASH, ANG. RANGE", "deg", -3.0, 3.0, 0.0},
};

static const kinematics_setting_description_t MODE_OF_453 = {
    .id = 406u,
    .is_whole = WHOLE,
    .name = "MODE",
    .unit = "",
    .low = -1.0,
    .high = 1.0,
};

const kinematics_setting_description_t *kinematics_settings_describe(uint32_t setting)
{
    return setting < KINEMATICS_SETTINGS ? &TABLE[setting] : NULL;
}

kinematics_setting_t kinematics_settings_find(uint16_t id)
{
    uint32_t setting = 0u;
    while (setting < KINEMATICS_SETTINGS && TABLE[setting].id != id) {
        setting++;
    }
    return (kinematics_setting_t)setting;
}

#define MODE_OF_452   1.0 /* positions */
#define PRESET_OF_452 0.0 /* never */

static bool is_of(kinematics_kind_t kind, kinematics_setting_t setting)
{
    bool is_fixed = setting == KINEMATICS_Q406_MODE || setting == KINEMATICS_Q431_PRESET;
    bool is_of_axis = (setting >= KINEMATICS_Q411_START_A && setting <= KINEMATICS_Q422_POINTS_C) ||
                      setting == KINEMATICS_Q432_BACKLASH_ANGLE;
    return setting < KINEMATICS_SETTINGS && !(kind == KINEMATICS_COMPENSATE_PRESET && is_fixed) &&
           !(kind == KINEMATICS_MEASURE_GRID && is_of_axis);
}

/* Also of what a cycle has not: that stands at its default. */
static const kinematics_setting_description_t *row_of(kinematics_kind_t    kind,
                                                      kinematics_setting_t setting)
{
    bool is_own = kind == KINEMATICS_MEASURE_GRID && setting == KINEMATICS_Q406_MODE;
    return is_own ? &MODE_OF_453 : &TABLE[setting];
}

const kinematics_setting_description_t *kinematics_settings_of(kinematics_kind_t    kind,
                                                               kinematics_setting_t setting)
{
    return is_of(kind, setting) ? row_of(kind, setting) : NULL;
}

void kinematics_settings_reset(kinematics_settings_t *settings, kinematics_kind_t kind)
{
    settings->kind = kind;
    for (uint32_t i = 0u; i < KINEMATICS_SETTINGS; i++) {
        settings->value[i] = TABLE[i].initial;
        settings->word[i] = KINEMATICS_NUMBER;
    }
    if (kind == KINEMATICS_COMPENSATE_PRESET) {
        settings->value[KINEMATICS_Q406_MODE] = MODE_OF_452;
        settings->value[KINEMATICS_Q431_PRESET] = PRESET_OF_452;
    }
}

static kinematics_setting_error_t check_value(const kinematics_setting_description_t *row,
                                              double                                  value)
{
    if (!isfinite(value)) {
        return KINEMATICS_SETTING_NOT_FINITE;
    }
    if (value < row->low) {
        return KINEMATICS_SETTING_LOW;
    }
    if (value > row->high) {
        return KINEMATICS_SETTING_HIGH;
    }
    /* Within limits of at most 12, so that it fits an int of 16 bits. */
    bool is_broken = row->is_whole && fabs(value - (int)value) > 0.0;
    return is_broken ? KINEMATICS_SETTING_NOT_WHOLE : KINEMATICS_SETTING_OK;
}

static bool is_word(const kinematics_setting_description_t *row, kinematics_word_t word)
{
    bool is_one = word == KINEMATICS_FMAX || word == KINEMATICS_FAUTO || word == KINEMATICS_PREDEF;
    return is_one && (row->words & (uint8_t)word) != 0u;
}

kinematics_setting_error_t kinematics_settings_check(const kinematics_settings_t *settings,
                                                     kinematics_setting_t         setting)
{
    if (setting >= KINEMATICS_SETTINGS) {
        return KINEMATICS_SETTING_UNKNOWN;
    }
    if (settings->word[setting] == KINEMATICS_NUMBER) {
        return check_value(row_of(settings->kind, setting), settings->value[setting]);
    }
    bool is_allowed = is_word(&TABLE[setting], settings->word[setting]);
    return is_allowed ? KINEMATICS_SETTING_OK : KINEMATICS_SETTING_WORD;
}

kinematics_setting_error_t kinematics_settings_set(kinematics_settings_t *settings, uint16_t id,
                                                   double value)
{
    kinematics_setting_t setting = kinematics_settings_find(id);
    if (!is_of(settings->kind, setting)) {
        return KINEMATICS_SETTING_UNKNOWN;
    }
    kinematics_setting_error_t error = check_value(row_of(settings->kind, setting), value);
    if (error == KINEMATICS_SETTING_OK) {
        settings->value[setting] = value;
        settings->word[setting] = KINEMATICS_NUMBER;
    }
    return error;
}

kinematics_setting_error_t kinematics_settings_set_word(kinematics_settings_t *settings,
                                                        uint16_t id, kinematics_word_t word)
{
    kinematics_setting_t setting = kinematics_settings_find(id);
    if (!is_of(settings->kind, setting)) {
        return KINEMATICS_SETTING_UNKNOWN;
    }
    if (!is_word(&TABLE[setting], word)) {
        return KINEMATICS_SETTING_WORD;
    }
    settings->word[setting] = word;
    return KINEMATICS_SETTING_OK;
}

kinematics_setting_t kinematics_settings_fault(const kinematics_settings_t *settings)
{
    uint32_t setting = 0u;
    while (setting < KINEMATICS_SETTINGS &&
           kinematics_settings_check(settings, (kinematics_setting_t)setting) ==
               KINEMATICS_SETTING_OK) {
        setting++;
    }
    return (kinematics_setting_t)setting;
}

const char *kinematics_settings_phrase(kinematics_setting_error_t error)
{
    switch (error) {
    case KINEMATICS_SETTING_OK:
        return "is sound";
    case KINEMATICS_SETTING_UNKNOWN:
        return "is no parameter of this cycle";
    case KINEMATICS_SETTING_LOW:
        return "is below its lower limit";
    case KINEMATICS_SETTING_HIGH:
        return "is above its upper limit";
    case KINEMATICS_SETTING_NOT_WHOLE:
        return "is not a whole number";
    case KINEMATICS_SETTING_NOT_FINITE:
        return "is not a finite number";
    case KINEMATICS_SETTING_WORD:
    default:
        return "does not take this word";
    }
}
