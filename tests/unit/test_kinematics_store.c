/* Cycle 450: what is saved comes back. */
/* LINK: firmware/cycle/kinematics_designation.c firmware/cycle/kinematics_slots.c
 *       firmware/cycle/kinematics_store.c firmware/cycle/kinematics_store_phrase.c
 *       firmware/cycle/kinematics_writes.c firmware/report/latch_crc.c
 *       tests/support/store_rig.c */
#include <math.h>
#include <string.h>

#include "cycle/kinematics_slots.h"
#include "cycle/kinematics_store.h"
#include "store_rig.h"
#include "unity.h"

void setUp(void)
{
    store_rig_set_up();
}

void tearDown(void)
{
}

/* ---- the four modes ---- */

void test_an_empty_memory_is_an_empty_store(void)
{
    kinematics_record_t record;

    for (int fill = 0; fill <= 0xFF; fill++) {
        memset(store_rig_memory, fill, sizeof store_rig_memory);
        store_rig_mount();
        TEST_ASSERT_EQUAL(KINEMATICS_STORE_OK, kinematics_store_check(&store_rig_store));
        TEST_ASSERT_EQUAL(0, store_rig_count());
        TEST_ASSERT_FALSE(kinematics_store_active(&store_rig_store, &record));
    }
}

/* The order that the header gives, and what comes of leaving out the writes that mounting brings.
 */
void test_a_memory_that_is_new_wants_its_marks_before_the_first_operation(void)
{
    static const uint8_t     payload[] = {1u, 2u, 3u};
    kinematics_store_write_t write;
    unsigned                 writes = 0u;
    memset(store_rig_memory, 0xFF, sizeof store_rig_memory);
    kinematics_store_mount(&store_rig_store, store_rig_memory);
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_ERR_BUSY,
                      kinematics_store_activate(&store_rig_store, payload, sizeof payload));

    while (kinematics_store_next_write(&store_rig_store, &write)) {
        memcpy(store_rig_memory + write.offset, write.bytes, write.length);
        ++writes;
    }

    TEST_ASSERT_EQUAL_UINT(KINEMATICS_STORE_SLOTS, writes);
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_OK,
                      kinematics_store_activate(&store_rig_store, payload, sizeof payload));
}

static void restore(kinematics_designation_t designation)
{
    store_rig_finish(store_rig_start(KINEMATICS_STORE_RESTORE, &designation));
}

void test_what_is_saved_is_restored_by_number_and_by_name(void)
{
    store_rig_activate("first");
    store_rig_save_as(store_rig_number(5));
    store_rig_activate("second");
    store_rig_save_as(store_rig_name("HEAD-1"));
    store_rig_activate("third");

    restore(store_rig_number(5));
    TEST_ASSERT_TRUE(store_rig_active_is("first"));
    restore(store_rig_name("HEAD-1"));
    TEST_ASSERT_TRUE(store_rig_active_is("second"));
    TEST_ASSERT_TRUE(store_rig_saved_is(store_rig_number(5), "first"));
    TEST_ASSERT_EQUAL(2, store_rig_count());
}

void test_saving_again_replaces(void)
{
    store_rig_activate("first");
    store_rig_save_as(store_rig_number(5));
    store_rig_activate("second");
    store_rig_save_as(store_rig_number(5));

    TEST_ASSERT_TRUE(store_rig_saved_is(store_rig_number(5), "second"));
    TEST_ASSERT_EQUAL(1, store_rig_count());
}

void test_deleting_leaves_the_others(void)
{
    kinematics_designation_t five = store_rig_number(5);

    store_rig_activate("first");
    store_rig_save_as(five);
    store_rig_save_as(store_rig_name("5"));
    store_rig_finish(store_rig_start(KINEMATICS_STORE_DELETE, &five));

    TEST_ASSERT_FALSE(store_rig_is_saved(five));
    TEST_ASSERT_TRUE(store_rig_saved_is(store_rig_name("5"), "first"));
    TEST_ASSERT_TRUE(store_rig_active_is("first"));
    TEST_ASSERT_EQUAL(1, store_rig_count());
}

void test_showing_writes_nothing(void)
{
    kinematics_store_write_t write;

    TEST_ASSERT_EQUAL(KINEMATICS_STORE_OK, store_rig_start(KINEMATICS_STORE_SHOW, NULL));
    TEST_ASSERT_FALSE(kinematics_store_next_write(&store_rig_store, &write));
}

void test_everything_outlasts_a_new_start(void)
{
    store_rig_activate("first");
    store_rig_save_as(store_rig_number(5));
    store_rig_mount();

    TEST_ASSERT_TRUE(store_rig_active_is("first"));
    TEST_ASSERT_TRUE(store_rig_saved_is(store_rig_number(5), "first"));
}

void test_sixteen_records_fit_and_the_seventeenth_does_not(void)
{
    kinematics_designation_t more = store_rig_number(99);

    store_rig_activate("same");
    for (uint32_t i = 0u; i < KINEMATICS_STORE_RECORDS; i++) {
        store_rig_save_as(store_rig_number(i));
    }
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_RECORDS, store_rig_count());
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_ERR_FULL, store_rig_start(KINEMATICS_STORE_SAVE, &more));
    TEST_ASSERT_TRUE(store_rig_write_until(0)); /* nothing to write */

    store_rig_activate("other"); /* with the store full */
    store_rig_save_as(store_rig_number(3));
    TEST_ASSERT_TRUE(store_rig_saved_is(store_rig_number(3), "other"));
    TEST_ASSERT_TRUE(store_rig_saved_is(store_rig_number(15), "same"));
    restore(store_rig_number(0));
    TEST_ASSERT_TRUE(store_rig_active_is("same"));
}

void test_the_longest_description_fits(void)
{
    uint8_t             payload[KINEMATICS_STORE_PAYLOAD_MAX + 1];
    kinematics_record_t record;

    memset(payload, 0xA5, sizeof payload);
    store_rig_finish(
        kinematics_store_activate(&store_rig_store, payload, KINEMATICS_STORE_PAYLOAD_MAX));
    store_rig_save_as(store_rig_number(1));
    restore(store_rig_number(1));
    TEST_ASSERT_TRUE(kinematics_store_active(&store_rig_store, &record));
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_PAYLOAD_MAX, record.length);
    TEST_ASSERT_EQUAL_MEMORY(payload, record.payload, record.length);

    TEST_ASSERT_EQUAL(KINEMATICS_STORE_ERR_LENGTH,
                      kinematics_store_activate(&store_rig_store, payload, sizeof payload));
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_ERR_LENGTH,
                      kinematics_store_activate(&store_rig_store, payload, 0));
    store_rig_finish(kinematics_store_activate(&store_rig_store, payload, 1));
}

/* The record that stands alone in the store gets another serial number. */
static void age(uint32_t serial)
{
    store_rig_activate("aged");
    for (uint8_t slot = 0u; slot < KINEMATICS_STORE_SLOTS; slot++) {
        uint8_t *bytes = store_rig_slot(slot);
        if (memcmp(bytes, SLOT_MARK, SLOT_MARK_BYTES) == 0) {
            kinematics_slot_put(bytes + AT_SERIAL, 4u, serial);
            store_rig_close(bytes);
        }
    }
    TEST_ASSERT_TRUE(store_rig_active_is("aged"));
}

/* With the one before marked again, as if power had failed before it was wiped. */
void test_serial_numbers_wrap(void)
{
    for (uint32_t back = 0u; back < 3u; back++) {
        setUp();
        age(UINT32_MAX - back);
        for (int i = 0; i < 6; i++) {
            const char *payload = i % 2 == 0 ? "even" : "odd";
            uint8_t     before[sizeof store_rig_memory];
            memcpy(before, store_rig_memory, sizeof store_rig_memory);
            store_rig_activate(payload);
            for (uint32_t at = 0u; at < sizeof before; at += KINEMATICS_STORE_SLOT_BYTES) {
                if (memcmp(before + at, SLOT_MARK, SLOT_MARK_BYTES) == 0) {
                    memcpy(store_rig_memory + at, SLOT_MARK, SLOT_MARK_BYTES);
                }
            }
            TEST_ASSERT_TRUE(store_rig_active_is(payload));
            store_rig_mount();
            TEST_ASSERT_TRUE(store_rig_active_is(payload));
        }
    }
}

/* ---- errors ---- */

void test_only_modes_0_to_3_are_known(void)
{
    const double             bad[] = {-1.0, 4.0, 0.5, 2.9999, 1e9, -1e300, (double)NAN, INFINITY};
    kinematics_designation_t five = store_rig_number(5);

    store_rig_activate("first");
    for (unsigned i = 0; i < sizeof bad / sizeof *bad; i++) {
        TEST_ASSERT_EQUAL(KINEMATICS_STORE_ERR_MODE,
                          kinematics_store_start(&store_rig_store, bad[i], &five));
        TEST_ASSERT_TRUE(store_rig_write_until(0));
    }
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_OK, kinematics_store_start(&store_rig_store, 0.0, &five));
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
    const char *const bad[] = {"", "12345678901234567", " A", "A ", "\t", "\x7F", "\xC3\xA4"};

    for (unsigned i = 0; i < sizeof bad / sizeof *bad; i++) {
        TEST_ASSERT_EQUAL(KINEMATICS_STORE_ERR_DESIGNATION,
                          kinematics_store_name(&designation, bad[i]));
    }
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_OK, kinematics_store_name(&designation, "!"));
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_OK, kinematics_store_name(&designation, "my old one"));
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_OK, kinematics_store_name(&designation, "1234567890123456"));
}

void test_designations_are_told_as_text(void)
{
    char                     text[KINEMATICS_STORE_NAME_MAX + 1];
    const uint32_t           numbers[] = {0u, 5u, 10u, 99u, 100u, 99999u};
    const char *const        texts[] = {"0", "5", "10", "99", "100", "99999"};
    kinematics_designation_t designation;

    for (unsigned i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        designation = store_rig_number(numbers[i]);
        kinematics_store_text(&designation, text);
        TEST_ASSERT_EQUAL_STRING(texts[i], text);
    }
    designation = store_rig_name("1234567890123456");
    kinematics_store_text(&designation, text);
    TEST_ASSERT_EQUAL_STRING("1234567890123456", text);
}

void test_what_is_not_there_can_neither_be_restored_nor_deleted(void)
{
    kinematics_designation_t five = store_rig_number(5);

    TEST_ASSERT_EQUAL(KINEMATICS_STORE_ERR_NO_ACTIVE,
                      store_rig_start(KINEMATICS_STORE_SAVE, &five));
    store_rig_activate("first");
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_ERR_NOT_FOUND,
                      store_rig_start(KINEMATICS_STORE_RESTORE, &five));
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_ERR_NOT_FOUND,
                      store_rig_start(KINEMATICS_STORE_DELETE, &five));
    TEST_ASSERT_TRUE(store_rig_write_until(0));
}

void test_the_active_description_has_no_designation(void)
{
    const kinematics_designation_t none = {{0}};

    store_rig_activate("first");
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_ERR_DESIGNATION,
                      store_rig_start(KINEMATICS_STORE_DELETE, &none));
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_ERR_DESIGNATION,
                      store_rig_start(KINEMATICS_STORE_SAVE, &none));
}

void test_one_operation_at_a_time(void)
{
    kinematics_designation_t five = store_rig_number(5);

    store_rig_activate("first");
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_OK, store_rig_start(KINEMATICS_STORE_SAVE, &five));
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_ERR_BUSY, store_rig_start(KINEMATICS_STORE_DELETE, &five));
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_ERR_BUSY,
                      kinematics_store_activate(&store_rig_store, (const uint8_t *)"x", 1));
    TEST_ASSERT_TRUE(store_rig_write_until(NEVER));
    TEST_ASSERT_TRUE(store_rig_saved_is(five, "first"));
}

void test_every_error_has_its_own_phrase(void)
{
    for (int i = KINEMATICS_STORE_OK; i <= KINEMATICS_STORE_ERR_FOREIGN; i++) {
        for (int j = KINEMATICS_STORE_OK; j < i; j++) {
            TEST_ASSERT_NOT_EQUAL(0, strcmp(kinematics_store_phrase((kinematics_store_error_t)i),
                                            kinematics_store_phrase((kinematics_store_error_t)j)));
        }
    }
}
