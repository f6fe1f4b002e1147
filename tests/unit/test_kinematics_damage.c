/* Cycle 450: lost bits and foreign contents are told, and never answered with something old. */
/* LINK: firmware/cycle/kinematics_designation.c firmware/cycle/kinematics_slots.c
 *       firmware/cycle/kinematics_store.c firmware/cycle/kinematics_store_phrase.c
 *       firmware/cycle/kinematics_writes.c firmware/report/latch_crc.c
 *       tests/support/store_rig.c */
#include <string.h>

#include "cycle/kinematics_slots.h"
#include "cycle/kinematics_store.h"
#include "store_rig.h"
#include "unity.h"

#define BODY_BYTES (AT_PAYLOAD - AT_CHECKSUM + 9) /* of "brand new" */

static uint8_t sound[KINEMATICS_STORE_BYTES];

void setUp(void)
{
    store_rig_set_up();
}

void tearDown(void)
{
}

static kinematics_store_error_t check(void)
{
    return kinematics_store_check(&store_rig_store);
}

static void flip(uint32_t bit)
{
    store_rig_memory[bit / 8u] ^= (uint8_t)(1u << bit % 8u);
}

/* A store with a history: everything in it has replaced something. */
static void fill(void)
{
    setUp();
    store_rig_activate("old one");
    store_rig_save_as(store_rig_number(1));
    store_rig_activate("one");
    store_rig_save_as(store_rig_number(1));
    store_rig_activate("older");
    store_rig_activate("new");
}

static bool all_is_there(void)
{
    return store_rig_active_is("new") && store_rig_saved_is(store_rig_number(1), "one") &&
           store_rig_count() == 1;
}

static bool anything_is_found(void)
{
    kinematics_record_t record;
    return kinematics_store_active(&store_rig_store, &record) ||
           store_rig_is_saved(store_rig_number(1)) || store_rig_count() != 0;
}

/* ---- lost bits ---- */

void test_any_flipped_bit_of_any_slot_is_harmless_or_told(void)
{
    uint32_t told = 0u;

    fill();
    memcpy(sound, store_rig_memory, sizeof sound);
    for (uint32_t bit = 0u; bit < 8u * sizeof store_rig_memory; bit++) {
        flip(bit);
        kinematics_store_mount(&store_rig_store, store_rig_memory);
        bool is_told = check() == KINEMATICS_STORE_ERR_DAMAGED && !anything_is_found();
        TEST_ASSERT_TRUE(is_told || (check() == KINEMATICS_STORE_OK && all_is_there()));
        told += is_told;
        memcpy(store_rig_memory, sound, sizeof sound);
    }
    TEST_ASSERT_EQUAL(8u * (25u + 3u + 25u + 3u), told); /* every bit of the two records */
}

/* Power fails between any two bytes, and then a bit is lost before it comes back. */
void test_a_flipped_bit_after_a_power_cut_brings_nothing_old_back(void)
{
    bool is_complete = false;
    for (int bytes = 0; !is_complete; bytes++) {
        fill();
        kinematics_store_activate(&store_rig_store, (const uint8_t *)"brand new", 9);
        is_complete = store_rig_write_until(bytes);
        memcpy(sound, store_rig_memory, sizeof sound);
        kinematics_store_mount(&store_rig_store, store_rig_memory);
        bool was_new = store_rig_active_is("brand new");
        bool is_in_mark = bytes > BODY_BYTES && bytes < BODY_BYTES + SLOT_MARK_BYTES;
        for (uint32_t bit = 0u; bit < 8u * sizeof store_rig_memory; bit++) {
            uint32_t place = bit / 8u % KINEMATICS_STORE_SLOT_BYTES;
            if (place >= AT_PAYLOAD + 9u || (place >= SLOT_MARK_BYTES && place < AT_CHECKSUM)) {
                continue; /* nothing stands there */
            }
            flip(bit);
            store_rig_mount();
            bool is_new = store_rig_active_is("brand new");
            bool is_told = check() == KINEMATICS_STORE_ERR_DAMAGED && !anything_is_found();
            /* Which way a mark tips that is half written is the power cut's to decide. */
            TEST_ASSERT_TRUE(is_told || is_new == was_new || is_in_mark);
            memcpy(store_rig_memory, sound, sizeof sound);
        }
    }
}

void test_a_damaged_store_is_not_written_until_the_loss_is_accepted(void)
{
    kinematics_designation_t one = store_rig_number(1);
    uint8_t                  slot = 0u;

    fill();
    while (!kinematics_slot_is_of(store_rig_slot(slot), &one) ||
           memcmp(store_rig_slot(slot), SLOT_MARK, SLOT_MARK_BYTES) != 0) {
        slot++;
    }
    store_rig_slot(slot)[AT_PAYLOAD] ^= 1u;
    memcpy(sound, store_rig_memory, sizeof sound);
    store_rig_mount();
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_ERR_DAMAGED,
                      kinematics_store_activate(&store_rig_store, (const uint8_t *)"x", 1));
    for (int mode = KINEMATICS_STORE_SAVE; mode <= KINEMATICS_STORE_DELETE; mode++) {
        TEST_ASSERT_EQUAL(KINEMATICS_STORE_ERR_DAMAGED,
                          store_rig_start((kinematics_store_mode_t)mode, &one));
    }
    TEST_ASSERT_TRUE(store_rig_write_until(0));
    TEST_ASSERT_EQUAL_MEMORY(sound, store_rig_memory, sizeof sound);

    store_rig_finish(kinematics_store_discard_damaged(&store_rig_store));
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_OK, check());
    TEST_ASSERT_TRUE(store_rig_active_is("new"));
    TEST_ASSERT_EQUAL(0, store_rig_count());
}

void test_a_discarded_slot_is_used_again(void)
{
    fill();
    for (uint8_t slot = 0u; slot < KINEMATICS_STORE_SLOTS; slot++) {
        store_rig_slot(slot)[AT_PAYLOAD] ^= 1u;
    }
    store_rig_finish(kinematics_store_discard_damaged(&store_rig_store));
    store_rig_activate("again");
    for (uint32_t i = 0u; i < KINEMATICS_STORE_RECORDS; i++) {
        store_rig_save_as(store_rig_number(i));
    }
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_RECORDS, store_rig_count());
}

void test_a_mark_bears_eight_wrong_bits_and_is_written_anew(void)
{
    fill();
    for (uint8_t slot = 0u; slot < KINEMATICS_STORE_SLOTS; slot++) {
        store_rig_slot(slot)[AT_MARK] ^= 0xFFu;
    }
    store_rig_mount();
    TEST_ASSERT_TRUE(all_is_there());
    for (uint8_t slot = 0u; slot < KINEMATICS_STORE_SLOTS; slot++) {
        const uint8_t *mark = store_rig_slot(slot);
        TEST_ASSERT_TRUE(memcmp(mark, SLOT_MARK, SLOT_MARK_BYTES) == 0 ||
                         memcmp(mark, SLOT_WIPED, SLOT_MARK_BYTES) == 0);
    }
}

/* A memory that no longer takes what is written costs the new description, not the old one. */
void test_what_is_replaced_stays_where_its_successor_cannot_be_read(void)
{
    kinematics_store_write_t write;

    fill();
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_OK,
                      kinematics_store_activate(&store_rig_store, (const uint8_t *)"lost", 4));
    while (kinematics_store_next_write(&store_rig_store, &write)) {
        if (write.offset % KINEMATICS_STORE_SLOT_BYTES == AT_MARK) {
            TEST_ASSERT_EQUAL_MEMORY(SLOT_MARK, write.bytes, SLOT_MARK_BYTES);
        }
    }
    TEST_ASSERT_TRUE(all_is_there());
}

/* ---- foreign contents ---- */

static void refuse_as_foreign(void)
{
    memcpy(sound, store_rig_memory, sizeof sound);
    store_rig_mount();
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_ERR_FOREIGN, check());
    TEST_ASSERT_FALSE(anything_is_found());
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_ERR_FOREIGN,
                      kinematics_store_activate(&store_rig_store, (const uint8_t *)"x", 1));
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_ERR_FOREIGN,
                      kinematics_store_discard_damaged(&store_rig_store));
    TEST_ASSERT_TRUE(store_rig_write_until(0));
    TEST_ASSERT_EQUAL_MEMORY(sound, store_rig_memory, sizeof sound);
}

void test_a_store_without_a_free_slot_is_refused(void)
{
    for (uint8_t slot = 0u; slot < KINEMATICS_STORE_SLOTS; slot++) {
        kinematics_designation_t designation = store_rig_number(slot);
        store_rig_forge(slot, slot, &designation, "full");
    }
    refuse_as_foreign();
}

void test_a_designation_that_nobody_can_give_is_refused(void)
{
    const kinematics_designation_t bad[] = {
        {{3}},                   /* neither active nor number nor name */
        {{0, 1}},                /* an active one with a name */
        {{1, 0xA0, 0x86, 0x01}}, /* 100,000 */
        {{1, 5, 0, 0, 0, 1}},    /* more than a number */
        {{2}},                   /* an empty name */
        {{2, 'A', 0, 'B'}},      /* a name after its end */
        {{2, 'A', ' '}},
        {{2, ' ', 'A'}},
        {{2, 0xC3, 0xA4}}, /* unprintable */
    };
    for (unsigned i = 0; i < sizeof bad / sizeof *bad; i++) {
        setUp();
        store_rig_forge(4u, 1u, &bad[i], "foreign");
        refuse_as_foreign();
    }
}

void test_two_that_are_equally_new_are_refused(void)
{
    kinematics_designation_t one = store_rig_number(1);
    const uint32_t           ahead[] = {0u, 0x80000000u};

    for (unsigned i = 0; i < 2u; i++) {
        setUp();
        store_rig_forge(2u, 7u, &one, "first");
        store_rig_forge(5u, 7u + ahead[i], &one, "second");
        refuse_as_foreign();
    }
}

/* Whatever stands in the memory, nothing is written outside. */
void test_any_contents_are_borne(void)
{
    uint32_t random = 1u;
    for (int round = 0; round < 2000; round++) {
        for (uint8_t slot = 0u; slot < KINEMATICS_STORE_SLOTS; slot++) {
            random = random * 1664525u + 1013904223u;
            kinematics_designation_t some = {{(uint8_t)(random >> 28), (uint8_t)(random >> 24)}};
            store_rig_forge(slot, random >> 8, &some, "foreign");
            if ((random >> 20) % 4u == 0u) {
                store_rig_slot(slot)[(random >> 9) % KINEMATICS_STORE_SLOT_BYTES] ^= 0xFFu;
            }
        }
        store_rig_mount();
        store_rig_write_until(kinematics_store_discard_damaged(&store_rig_store) == 0 ? NEVER : 0);
        (void)kinematics_store_activate(&store_rig_store, (const uint8_t *)"mine", 4);
        store_rig_write_until(NEVER);
        TEST_ASSERT_TRUE(check() != KINEMATICS_STORE_OK || store_rig_active_is("mine"));
    }
}
