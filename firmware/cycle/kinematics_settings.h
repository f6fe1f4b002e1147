/*
 * The parameters of cycles 451, 452 and 453 in one table: number, name, limits and default. The
 * limits are those of the document, also where it is not consistent (Q417); the defaults are what
 * its first program has. Cycle 452 has all of 451 but Q406 and Q431: it corrects positions and sets
 * no preset. Cycle 453 has those that are of no axis, without Q432, and modes of its own. Lengths
 * in mm, angles in degrees, feeds in mm/min.
 */
#ifndef CYCLE_KINEMATICS_SETTINGS_H
#define CYCLE_KINEMATICS_SETTINGS_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* In the order of the document. */
typedef enum {
    KINEMATICS_Q406_MODE,
    KINEMATICS_Q407_SPHERE_RADIUS,
    KINEMATICS_Q320_CLEARANCE,
    KINEMATICS_Q408_RETRACT_HEIGHT,
    KINEMATICS_Q253_FEED,
    KINEMATICS_Q380_REFERENCE_ANGLE,
    KINEMATICS_Q411_START_A,
    KINEMATICS_Q412_END_A,
    KINEMATICS_Q413_INCIDENCE_A,
    KINEMATICS_Q414_POINTS_A,
    KINEMATICS_Q415_START_B,
    KINEMATICS_Q416_END_B,
    KINEMATICS_Q417_INCIDENCE_B,
    KINEMATICS_Q418_POINTS_B,
    KINEMATICS_Q419_START_C,
    KINEMATICS_Q420_END_C,
    KINEMATICS_Q421_INCIDENCE_C,
    KINEMATICS_Q422_POINTS_C,
    KINEMATICS_Q423_TOUCHES,
    KINEMATICS_Q431_PRESET,
    KINEMATICS_Q432_BACKLASH_ANGLE,
    KINEMATICS_SETTINGS
} kinematics_setting_t;

/* Which cycle the parameters are of. */
typedef enum {
    KINEMATICS_MEASURE,           /* 451 */
    KINEMATICS_COMPENSATE_PRESET, /* 452 */
    KINEMATICS_MEASURE_GRID       /* 453 */
} kinematics_kind_t;

/* What may stand in place of a number. */
typedef enum {
    KINEMATICS_NUMBER = 0,
    KINEMATICS_FMAX = 1,  /* rapid traverse */
    KINEMATICS_FAUTO = 2, /* the feed of the TOOL CALL */
    KINEMATICS_PREDEF = 4 /* the value of GLOBAL DEF */
} kinematics_word_t;

typedef struct {
    uint16_t    id; /* 406 for Q406 */
    bool        is_whole;
    uint8_t     words; /* the kinematics_word_t that are allowed, or-ed */
    const char *name;
    const char *unit; /* "mm", "mm/min", "deg" or "" */
    double      low;
    double      high; /* still allowed, as low is */
    double      initial;
} kinematics_setting_description_t;

/* Indexed by kinematics_setting_t. */
typedef struct {
    double            value[KINEMATICS_SETTINGS];
    kinematics_word_t word[KINEMATICS_SETTINGS];
    kinematics_kind_t kind;
} kinematics_settings_t;

typedef enum {
    KINEMATICS_SETTING_OK,
    KINEMATICS_SETTING_UNKNOWN, /* the cycle has no such number */
    KINEMATICS_SETTING_LOW,
    KINEMATICS_SETTING_HIGH,
    KINEMATICS_SETTING_NOT_WHOLE,
    KINEMATICS_SETTING_NOT_FINITE,
    KINEMATICS_SETTING_WORD /* this word is not allowed here */
} kinematics_setting_error_t;

/* Row `setting` of the table as cycle 451 has it, or NULL past its end. Any context. */
const kinematics_setting_description_t *kinematics_settings_describe(uint32_t setting);

/* The same as a cycle has it; NULL if it has no such parameter. Any context. */
const kinematics_setting_description_t *kinematics_settings_of(kinematics_kind_t    kind,
                                                               kinematics_setting_t setting);

/* Index of Q<id>, KINEMATICS_SETTINGS if no cycle has such a parameter. Any context. */
kinematics_setting_t kinematics_settings_find(uint16_t id);

/* Every parameter of a cycle at its default; those that 452 has not, at what it does. Any context.
 */
void kinematics_settings_reset(kinematics_settings_t *settings, kinematics_kind_t kind);

/* Check one parameter, respectively set it once it is sound. Any context. */
kinematics_setting_error_t kinematics_settings_check(const kinematics_settings_t *settings,
                                                     kinematics_setting_t         setting);
kinematics_setting_error_t kinematics_settings_set(kinematics_settings_t *settings, uint16_t id,
                                                   double value);
kinematics_setting_error_t kinematics_settings_set_word(kinematics_settings_t *settings,
                                                        uint16_t id, kinematics_word_t word);

/* The first parameter that is not sound, KINEMATICS_SETTINGS if all are. Any context. */
kinematics_setting_t kinematics_settings_fault(const kinematics_settings_t *settings);

/* A phrase like "is below its limit". Any context. */
const char *kinematics_settings_phrase(kinematics_setting_error_t error);

#ifdef __cplusplus
}
#endif

#endif
