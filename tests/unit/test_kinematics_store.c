/* Cycle 450: what is saved comes back, and a power cut anywhere leaves the old or the new. */
/* LINK: firmware/cycle/kinematics_slots.c firmware/cycle/kinematics_store.c
 *       firmware/report/crc16.c */
#include <math.h>
#include <string.h>

#include "cycle/kinematics_store.h"
#include "report/crc16.h"
#include "unity.h"

#define NEVER 1000000

static uint8_t            memory[KINEMATICS_STORE_BYTES];
static kinematics_store_t store;

void setUp(void)
{
    memset(memory, 0xFF, sizeof memory);
    kinematics_store_mount(&store, memory);
}

void tearDown(void)
{
}

/* ---- carrying out ---- */

/* Power fails after `bytes` bytes; true if all was written before. */
static bool write_until(int bytes)
{
    kinematics_store_write_t write;

    while (kinematics_store_next_write(&store, &write)) {
        TEST_ASSERT_TRUE(write.length > 0 && write.length <= KINEMATICS_STORE_WRITE_MAX);
        TEST_ASSERT_TRUE(write.offset + write.length <= KINEMATICS_STORE_BYTES);
        for (uint32_t i = 0u; i < write.length; i++) {
            if (bytes-- == 0) {
                return false;
            }
            memory[write.offset + i] = write.bytes[i];
        }
    }
    return true;
}

static void finish(kinematics_store_error_t error)
{
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_OK, error);
    TEST_ASSERT_TRUE(write_until(NEVER));
}

static kinematics_designation_t number(uint32_t value)
{
    kinematics_designation_t designation;
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_OK, kinematics_store_number(&designation, value));
    return designation;
}

static kinematics_designation_t name(const char *text)
{
    kinematics_designation_t designation;
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_OK, kinematics_store_name(&designation, text));
    return designation;
}

static kinematics_store_error_t start(kinematics_store_mode_t         mode,
                                      const kinematics_designation_t *designation)
{
    return kinematics_store_start(&store, (double)mode, designation);
}

static void activate(const char *payload)
{
    finish(kinematics_store_activate(&store, (const uint8_t *)payload, (uint16_t)strlen(payload)));
}

static void save_as(kinematics_designation_t designation)
{
    finish(start(KINEMATICS_STORE_SAVE, &designation));
}

static bool is(bool found, const kinematics_record_t *record, const char *payload)
{
    return found && record->length == strlen(payload) &&
           memcmp(record->payload, payload, record->length) == 0;
}

static bool active_is(const char *payload)
{
    kinematics_record_t record;
    bool                found = kinematics_store_active(&store, &record);
    return is(found, &record, payload);
}

static bool saved_is(kinematics_designation_t designation, const char *payload)
{
    kinematics_record_t record;
    bool                found = kinematics_store_find(&store, &designation, &record);
    return is(found, &record, payload);
}

static bool is_saved(kinematics_designation_t designation)
{
    kinematics_record_t record;
    return kinematics_store_find(&store, &designation, &record);
}

static int count(void)
{
    kinematics_record_t record;
    int                 records = 0;
    while (kinematics_store_show(&store, (uint8_t)records, &record)) {
        records++;
    }
    return records;
}

/* ---- the four modes ---- */

void test_an_empty_memory_is_an_empty_store(void)
{
    kinematics_record_t record;

    for (int fill = 0; fill <= 0xFF; fill++) {
        memset(memory, fill, sizeof memory);
        TEST_ASSERT_EQUAL(0, count());
        TEST_ASSERT_FALSE(kinematics_store_active(&store, &record));
    }
}

static void restore(kinematics_designation_t designation)
{
    finish(start(KINEMATICS_STORE_RESTORE, &designation));
}

void test_what_is_saved_is_restored_by_number_and_by_name(void)
{
    activate("first");
    save_as(number(5));
    activate("second");
    save_as(name("HEAD-1"));
    activate("third");

    restore(number(5));
    TEST_ASSERT_TRUE(active_is("first"));
    restore(name("HEAD-1"));
    TEST_ASSERT_TRUE(active_is("second"));
    TEST_ASSERT_TRUE(saved_is(number(5), "first"));
    TEST_ASSERT_EQUAL(2, count());
}

void test_saving_again_replaces(void)
{
    activate("first");
    save_as(number(5));
    activate("second");
    save_as(number(5));

    TEST_ASSERT_TRUE(saved_is(number(5), "second"));
    TEST_ASSERT_EQUAL(1, count());
}

void test_deleting_leaves_the_others(void)
{
    kinematics_designation_t five = number(5);

    activate("first");
    save_as(five);
    save_as(name("5"));
    finish(start(KINEMATICS_STORE_DELETE, &five));

    TEST_ASSERT_FALSE(is_saved(five));
    TEST_ASSERT_TRUE(saved_is(name("5"), "first"));
    TEST_ASSERT_TRUE(active_is("first"));
    TEST_ASSERT_EQUAL(1, count());
}

void test_showing_writes_nothing(void)
{
    kinematics_store_write_t write;

    TEST_ASSERT_EQUAL(KINEMATICS_STORE_OK, start(KINEMATICS_STORE_SHOW, NULL));
    TEST_ASSERT_FALSE(kinematics_store_next_write(&store, &write));
}

void test_everything_outlasts_a_new_start(void)
{
    activate("first");
    save_as(number(5));
    kinematics_store_mount(&store, memory);

    TEST_ASSERT_TRUE(active_is("first"));
    TEST_ASSERT_TRUE(saved_is(number(5), "first"));
}

void test_sixteen_records_fit_and_the_seventeenth_does_not(void)
{
    kinematics_designation_t more = number(99);

    activate("same");
    for (uint32_t i = 0u; i < KINEMATICS_STORE_RECORDS; i++) {
        save_as(number(i));
    }
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_RECORDS, count());
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_ERR_FULL, start(KINEMATICS_STORE_SAVE, &more));
    TEST_ASSERT_TRUE(write_until(0)); /* nothing to write */

    activate("other"); /* with the store full */
    save_as(number(3));
    TEST_ASSERT_TRUE(saved_is(number(3), "other"));
    TEST_ASSERT_TRUE(saved_is(number(15), "same"));
    restore(number(0));
    TEST_ASSERT_TRUE(active_is("same"));
}

void test_the_longest_description_fits(void)
{
    uint8_t             payload[KINEMATICS_STORE_PAYLOAD_MAX + 1];
    kinematics_record_t record;

    memset(payload, 0xA5, sizeof payload);
    finish(kinematics_store_activate(&store, payload, KINEMATICS_STORE_PAYLOAD_MAX));
    save_as(number(1));
    restore(number(1));
    TEST_ASSERT_TRUE(kinematics_store_active(&store, &record));
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_PAYLOAD_MAX, record.length);
    TEST_ASSERT_EQUAL_MEMORY(payload, record.payload, record.length);

    TEST_ASSERT_EQUAL(KINEMATICS_STORE_ERR_LENGTH,
                      kinematics_store_activate(&store, payload, sizeof payload));
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_ERR_LENGTH, kinematics_store_activate(&store, payload, 0));
    finish(kinematics_store_activate(&store, payload, 1));
}

/* The serial number of the newest record to come, by an own writing of the slot's format. */
static void age(uint32_t serial)
{
    activate("aged");
    for (int slot = 0; slot < KINEMATICS_STORE_SLOTS; slot++) {
        uint8_t *bytes = memory + slot * KINEMATICS_STORE_SLOT_BYTES;
        if (bytes[0] == 0xA5) {
            for (int i = 0; i < 4; i++) {
                bytes[3 + i] = (uint8_t)(serial >> (8 * i));
            }
            uint16_t sum = crc16_update(CRC16_START, bytes + 3, 23 + strlen("aged"));
            bytes[1] = (uint8_t)(sum & 0xFFu);
            bytes[2] = (uint8_t)(sum >> 8);
        }
    }
    TEST_ASSERT_TRUE(active_is("aged"));
}

/* Without the wipe at the end two records of one designation are left, and the newer one counts. */
void test_serial_numbers_wrap(void)
{
    for (uint32_t back = 0u; back < 3u; back++) {
        setUp();
        age(UINT32_MAX - back);
        for (int i = 0; i < 6; i++) {
            const char *payload = i % 2 == 0 ? "even" : "odd";
            uint8_t     before[sizeof memory];
            memcpy(before, memory, sizeof memory);
            activate(payload);
            for (int slot = 0; slot < KINEMATICS_STORE_SLOTS; slot++) {
                int mark = slot * KINEMATICS_STORE_SLOT_BYTES;
                if (before[mark] == 0xA5) {
                    memory[mark] = 0xA5; /* as if power had failed just before */
                }
            }
            TEST_ASSERT_TRUE(active_is(payload));
        }
    }
}

/* ---- errors ---- */

void test_only_modes_0_to_3_are_known(void)
{
    const double             bad[] = {-1.0, 4.0, 0.5, 2.9999, 1e9, -1e300, (double)NAN, INFINITY};
    kinematics_designation_t five = number(5);

    activate("first");
    for (unsigned i = 0; i < sizeof bad / sizeof *bad; i++) {
        TEST_ASSERT_EQUAL(KINEMATICS_STORE_ERR_MODE, kinematics_store_start(&store, bad[i], &five));
        TEST_ASSERT_TRUE(write_until(0));
    }
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_OK, kinematics_store_start(&store, 0.0, &five));
}

void test_numbers_are_whole_and_within_limits(void)
{
    kinematics_designation_t designation;
    const double             bad[] = {-1.0, -0.0001, 0.5, 100000.0, 99999.0001, NAN, INFINITY};

    for (unsigned i = 0; i < sizeof bad / sizeof *bad; i++) {
        TEST_ASSERT_EQUAL(KINEMATICS_STORE_ERR_DESIGNATION,
                          kinematics_store_number(&designation, bad[i]));
    }
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_OK, kinematics_store_number(&designation, 0.0));
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_OK, kinematics_store_number(&designation, 99999.0));
}

void test_names_have_1_to_16_printable_characters(void)
{
    kinematics_designation_t designation;
    const char *const        bad[] = {"", "12345678901234567", "A B", "\t", "\x7F", "\xC3\xA4"};

    for (unsigned i = 0; i < sizeof bad / sizeof *bad; i++) {
        TEST_ASSERT_EQUAL(KINEMATICS_STORE_ERR_DESIGNATION,
                          kinematics_store_name(&designation, bad[i]));
    }
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_OK, kinematics_store_name(&designation, "!"));
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_OK, kinematics_store_name(&designation, "1234567890123456"));
}

void test_designations_are_told_as_text(void)
{
    char                     text[KINEMATICS_STORE_NAME_MAX + 1];
    const uint32_t           numbers[] = {0u, 5u, 10u, 99u, 100u, 99999u};
    const char *const        texts[] = {"0", "5", "10", "99", "100", "99999"};
    kinematics_designation_t designation;

    for (unsigned i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        designation = number(numbers[i]);
        kinematics_store_text(&designation, text);
        TEST_ASSERT_EQUAL_STRING(texts[i], text);
    }
    designation = name("1234567890123456");
    kinematics_store_text(&designation, text);
    TEST_ASSERT_EQUAL_STRING("1234567890123456", text);
}

void test_what_is_not_there_can_neither_be_restored_nor_deleted(void)
{
    kinematics_designation_t five = number(5);

    TEST_ASSERT_EQUAL(KINEMATICS_STORE_ERR_NO_ACTIVE, start(KINEMATICS_STORE_SAVE, &five));
    activate("first");
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_ERR_NOT_FOUND, start(KINEMATICS_STORE_RESTORE, &five));
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_ERR_NOT_FOUND, start(KINEMATICS_STORE_DELETE, &five));
    TEST_ASSERT_TRUE(write_until(0));
}

void test_the_active_description_has_no_designation(void)
{
    const kinematics_designation_t none = {{0}};

    activate("first");
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_ERR_DESIGNATION, start(KINEMATICS_STORE_DELETE, &none));
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_ERR_DESIGNATION, start(KINEMATICS_STORE_SAVE, &none));
}

void test_one_operation_at_a_time(void)
{
    kinematics_designation_t five = number(5);

    activate("first");
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_OK, start(KINEMATICS_STORE_SAVE, &five));
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_ERR_BUSY, start(KINEMATICS_STORE_DELETE, &five));
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_ERR_BUSY,
                      kinematics_store_activate(&store, (const uint8_t *)"x", 1));
    TEST_ASSERT_TRUE(write_until(NEVER));
    TEST_ASSERT_TRUE(saved_is(five, "first"));
}

void test_every_error_has_its_own_phrase(void)
{
    for (int i = KINEMATICS_STORE_OK; i <= KINEMATICS_STORE_ERR_BUSY; i++) {
        for (int j = KINEMATICS_STORE_OK; j < i; j++) {
            TEST_ASSERT_NOT_EQUAL(0, strcmp(kinematics_store_phrase((kinematics_store_error_t)i),
                                            kinematics_store_phrase((kinematics_store_error_t)j)));
        }
    }
}

/* ---- damage ---- */

void test_any_flipped_bit_in_a_record_loses_that_record_alone(void)
{
    activate("first");
    save_as(number(5));
    save_as(number(6));
    uint8_t  before[sizeof memory];
    uint32_t lost = 0u;
    memcpy(before, memory, sizeof memory);
    for (uint32_t bit = 0u; bit < 8u * 3u * KINEMATICS_STORE_SLOT_BYTES; bit++) {
        memory[bit / 8u] ^= (uint8_t)(1u << bit % 8u);
        int there =
            active_is("first") + saved_is(number(5), "first") + saved_is(number(6), "first");
        TEST_ASSERT_TRUE(there >= 2);
        lost += there == 2;
        memcpy(memory, before, sizeof memory);
    }
    TEST_ASSERT_EQUAL(8u * 3u * (26u + 5u), lost); /* every bit of the three records matters */
}

void test_a_damaged_slot_is_used_again(void)
{
    activate("first");
    save_as(number(5));
    memory[KINEMATICS_STORE_SLOT_BYTES + 30]++;
    TEST_ASSERT_FALSE(active_is("first") && is_saved(number(5)));
    for (uint32_t i = 0u; i < KINEMATICS_STORE_RECORDS; i++) {
        activate("again");
        save_as(number(i));
    }
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_RECORDS, count());
}

void test_a_damaged_slot_loses_its_mark_before_it_is_filled(void)
{
    kinematics_store_write_t write;

    activate("first");
    memory[30]++;
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_OK,
                      kinematics_store_activate(&store, (const uint8_t *)"second", 6));
    TEST_ASSERT_TRUE(kinematics_store_next_write(&store, &write));

    TEST_ASSERT_EQUAL(0u, write.offset);
    TEST_ASSERT_EQUAL(1u, write.length);
    TEST_ASSERT_NOT_EQUAL(0xA5, write.bytes[0]);
}

/* ---- power cuts ---- */

typedef enum { SAVE_NEW, SAVE_OVER, RESTORE, ACTIVATE, DELETE, OPERATIONS } operation_t;

#define CROWD (KINEMATICS_STORE_RECORDS - 3) /* with them a third record fills the store */

static int crowd; /* further records */

/* Records 1 and 2, and an active description; the deleted record 3 is left in a free slot. */
static void fill(void)
{
    kinematics_designation_t three = number(3);

    setUp();
    activate("one");
    save_as(number(1));
    activate("two");
    save_as(number(2));
    activate("old");
    save_as(three);
    for (int i = 0; i < crowd; i++) {
        save_as(number(100u + (uint32_t)i));
    }
    finish(start(KINEMATICS_STORE_DELETE, &three));
}

static kinematics_store_error_t operate(operation_t operation)
{
    kinematics_designation_t one = number(1);
    kinematics_designation_t four = number(4);

    switch (operation) {
    case SAVE_NEW:
        return start(KINEMATICS_STORE_SAVE, &four);
    case SAVE_OVER:
        return start(KINEMATICS_STORE_SAVE, &one);
    case RESTORE:
        return start(KINEMATICS_STORE_RESTORE, &one);
    case DELETE:
        return start(KINEMATICS_STORE_DELETE, &one);
    case ACTIVATE:
    case OPERATIONS:
    default:
        return kinematics_store_activate(&store, (const uint8_t *)"new", 3);
    }
}

static bool is_old(operation_t operation)
{
    (void)operation;
    return count() == 2 + crowd && saved_is(number(1), "one") && active_is("old");
}

static bool is_new(operation_t operation)
{
    switch (operation) {
    case SAVE_NEW:
        return count() == 3 + crowd && saved_is(number(4), "old") && saved_is(number(1), "one") &&
               active_is("old");
    case SAVE_OVER:
        return count() == 2 + crowd && saved_is(number(1), "old") && active_is("old");
    case RESTORE:
        return count() == 2 + crowd && saved_is(number(1), "one") && active_is("one");
    case DELETE:
        return count() == 1 + crowd && !is_saved(number(1)) && active_is("old");
    case ACTIVATE:
    case OPERATIONS:
    default:
        return count() == 2 + crowd && saved_is(number(1), "one") && active_is("new");
    }
}

/* Power comes back: it is the old or the new; what was begun is done again, and then it is new. */
static void check_after_a_cut(operation_t operation, bool was_complete)
{
    kinematics_store_mount(&store, memory);
    bool became_new = is_new(operation);

    TEST_ASSERT_TRUE_MESSAGE(became_new != is_old(operation), "neither old nor new");
    TEST_ASSERT_TRUE(became_new || !was_complete);
    TEST_ASSERT_TRUE(saved_is(number(2), "two"));
    if (!(became_new && operation == DELETE)) {
        finish(operate(operation));
    }
    TEST_ASSERT_TRUE(is_new(operation));
    TEST_ASSERT_TRUE(saved_is(number(2), "two"));
}

void test_a_power_cut_after_any_byte_leaves_the_old_or_the_new(void)
{
    for (int i = 0; i < 2 * OPERATIONS; i++) {
        int  operation = i / 2;
        bool is_complete = false;
        crowd = i % 2 == 0 ? 0 : CROWD;
        for (int bytes = 0; !is_complete; bytes++) {
            fill();
            TEST_ASSERT_TRUE(is_old((operation_t)operation));
            TEST_ASSERT_EQUAL(KINEMATICS_STORE_OK, operate((operation_t)operation));
            is_complete = write_until(bytes);
            check_after_a_cut((operation_t)operation, is_complete);
        }
    }
}

void test_a_second_power_cut_while_doing_it_again_does_no_harm(void)
{
    crowd = 0;
    for (int operation = SAVE_NEW; operation < OPERATIONS; operation++) {
        bool first_complete = false;
        for (int bytes = 0; !first_complete; bytes++) {
            bool second_complete = false;
            for (int more = 0; !second_complete; more++) {
                fill();
                operate((operation_t)operation);
                first_complete = write_until(bytes);
                kinematics_store_mount(&store, memory);
                bool was_new = is_new((operation_t)operation);
                if (was_new && operation == DELETE) {
                    break;
                }
                TEST_ASSERT_EQUAL(KINEMATICS_STORE_OK, operate((operation_t)operation));
                second_complete = write_until(more);
                kinematics_store_mount(&store, memory);
                TEST_ASSERT_TRUE(is_new((operation_t)operation) ||
                                 (!was_new && is_old((operation_t)operation)));
            }
        }
    }
}

void test_what_was_saved_over_does_not_come_back_when_the_new_one_is_deleted(void)
{
    kinematics_designation_t one = number(1);

    crowd = 0;
    for (int bytes = 0; bytes < KINEMATICS_STORE_SLOT_BYTES; bytes++) {
        fill();
        operate(SAVE_OVER);
        write_until(bytes);
        kinematics_store_mount(&store, memory);
        finish(start(KINEMATICS_STORE_DELETE, &one));
        TEST_ASSERT_TRUE(is_new(DELETE));
    }
}

/* A byte that power fails in may hold anything. */
void test_a_byte_left_half_written_does_no_harm(void)
{
    for (int operation = SAVE_NEW; operation < OPERATIONS; operation++) {
        bool is_complete = false;
        crowd = CROWD;
        for (int steps = 0; !is_complete; steps++) {
            for (int garbage = 0; garbage <= 0xFF; garbage += 0x33) {
                kinematics_store_write_t write;
                fill();
                operate((operation_t)operation);
                for (int i = 0; i < steps && kinematics_store_next_write(&store, &write); i++) {
                    memcpy(memory + write.offset, write.bytes, write.length);
                }
                is_complete = !kinematics_store_next_write(&store, &write);
                if (!is_complete) {
                    memory[write.offset] = (uint8_t)garbage;
                }
                check_after_a_cut((operation_t)operation, is_complete);
            }
        }
    }
}
