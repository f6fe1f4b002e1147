/* Cycle 450: a power cut anywhere leaves the old or the new. */
/* LINK: firmware/cycle/kinematics_designation.c firmware/cycle/kinematics_slots.c
 *       firmware/cycle/kinematics_store.c firmware/cycle/kinematics_store_phrase.c
 *       firmware/cycle/kinematics_writes.c firmware/report/latch_crc.c
 *       tests/support/store_rig.c */
#include <string.h>

#include "store_rig.h"
#include "unity.h"

void setUp(void)
{
    store_rig_set_up();
}

void tearDown(void)
{
}

typedef enum { SAVE_NEW, SAVE_OVER, RESTORE, ACTIVATE, DELETE, OPERATIONS } operation_t;

#define CROWD (KINEMATICS_STORE_RECORDS - 3) /* with them a third record fills the store */

static int crowd; /* further records */

/* Records 1 and 2, and an active description; the deleted record 3 is left in a free slot. */
static void fill(void)
{
    kinematics_designation_t three = store_rig_number(3);

    setUp();
    store_rig_activate("one");
    store_rig_save_as(store_rig_number(1));
    store_rig_activate("two");
    store_rig_save_as(store_rig_number(2));
    store_rig_activate("old");
    store_rig_save_as(three);
    for (int i = 0; i < crowd; i++) {
        store_rig_save_as(store_rig_number(100u + (uint32_t)i));
    }
    store_rig_finish(store_rig_start(KINEMATICS_STORE_DELETE, &three));
}

static kinematics_store_error_t operate(operation_t operation)
{
    kinematics_designation_t one = store_rig_number(1);
    kinematics_designation_t four = store_rig_number(4);

    switch (operation) {
    case SAVE_NEW:
        return store_rig_start(KINEMATICS_STORE_SAVE, &four);
    case SAVE_OVER:
        return store_rig_start(KINEMATICS_STORE_SAVE, &one);
    case RESTORE:
        return store_rig_start(KINEMATICS_STORE_RESTORE, &one);
    case DELETE:
        return store_rig_start(KINEMATICS_STORE_DELETE, &one);
    case ACTIVATE:
    case OPERATIONS:
    default:
        return kinematics_store_activate(&store_rig_store, (const uint8_t *)"new", 3);
    }
}

static bool is_old(operation_t operation)
{
    (void)operation;
    return store_rig_count() == 2 + crowd && store_rig_saved_is(store_rig_number(1), "one") &&
           store_rig_active_is("old");
}

static bool is_new(operation_t operation)
{
    switch (operation) {
    case SAVE_NEW:
        return store_rig_count() == 3 + crowd && store_rig_saved_is(store_rig_number(4), "old") &&
               store_rig_saved_is(store_rig_number(1), "one") && store_rig_active_is("old");
    case SAVE_OVER:
        return store_rig_count() == 2 + crowd && store_rig_saved_is(store_rig_number(1), "old") &&
               store_rig_active_is("old");
    case RESTORE:
        return store_rig_count() == 2 + crowd && store_rig_saved_is(store_rig_number(1), "one") &&
               store_rig_active_is("one");
    case DELETE:
        return store_rig_count() == 1 + crowd && !store_rig_is_saved(store_rig_number(1)) &&
               store_rig_active_is("old");
    case ACTIVATE:
    case OPERATIONS:
    default:
        return store_rig_count() == 2 + crowd && store_rig_saved_is(store_rig_number(1), "one") &&
               store_rig_active_is("new");
    }
}

/* Power comes back: it is the old or the new; what was begun is done again, and then it is new. */
static void check_after_a_cut(operation_t operation, bool was_complete)
{
    kinematics_store_mount(&store_rig_store, store_rig_memory);
    bool became_new = is_new(operation);
    store_rig_mount();

    TEST_ASSERT_TRUE_MESSAGE(became_new != is_old(operation), "neither old nor new");
    TEST_ASSERT_TRUE(became_new || !was_complete);
    TEST_ASSERT_TRUE(store_rig_saved_is(store_rig_number(2), "two"));
    if (!(became_new && operation == DELETE)) {
        store_rig_finish(operate(operation));
    }
    TEST_ASSERT_TRUE(is_new(operation));
    TEST_ASSERT_TRUE(store_rig_saved_is(store_rig_number(2), "two"));
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
            is_complete = store_rig_write_until(bytes);
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
                first_complete = store_rig_write_until(bytes);
                store_rig_mount();
                bool was_new = is_new((operation_t)operation);
                if (was_new && operation == DELETE) {
                    break;
                }
                TEST_ASSERT_EQUAL(KINEMATICS_STORE_OK, operate((operation_t)operation));
                second_complete = store_rig_write_until(more);
                store_rig_mount();
                TEST_ASSERT_TRUE(is_new((operation_t)operation) ||
                                 (!was_new && is_old((operation_t)operation)));
            }
        }
    }
}

void test_what_was_saved_over_does_not_come_back_when_the_new_one_is_deleted(void)
{
    kinematics_designation_t one = store_rig_number(1);

    crowd = 0;
    for (int bytes = 0; bytes < KINEMATICS_STORE_SLOT_BYTES; bytes++) {
        fill();
        operate(SAVE_OVER);
        store_rig_write_until(bytes);
        store_rig_mount();
        store_rig_finish(store_rig_start(KINEMATICS_STORE_DELETE, &one));
        TEST_ASSERT_TRUE(is_new(DELETE));
    }
}

/* Fill the page that power failed in: as erased, as zeros, or at random. */
static void garble(uint32_t page_bytes, uint32_t seed)
{
    uint8_t *page = store_rig_memory + store_rig_cut_at / page_bytes * page_bytes;
    for (uint32_t i = 0u; i < page_bytes; i++) {
        seed = seed * 1664525u + 1013904223u;
        page[i] = seed < 2u ? 0u : (uint8_t)(seed >> 24);
    }
}

static void garble_constant(uint32_t page_bytes, uint8_t byte)
{
    memset(store_rig_memory + store_rig_cut_at / page_bytes * page_bytes, byte, page_bytes);
}

static void cut_and_garble(operation_t operation, uint32_t page_bytes, uint32_t kind)
{
    bool is_complete = false;
    for (int bytes = 0; !is_complete; bytes++) {
        fill();
        operate(operation);
        is_complete = store_rig_write_until(bytes);
        if (!is_complete && kind < 2u) {
            garble_constant(page_bytes, kind == 0u ? 0xFFu : 0x00u);
        } else if (!is_complete) {
            garble(page_bytes, kind * 1000u + (uint32_t)bytes);
        }
        check_after_a_cut(operation, is_complete);
    }
}

/* A memory that erases pages before it writes a byte. */
void test_a_page_garbled_by_a_power_cut_does_no_harm(void)
{
    for (int i = 0; i < 2 * OPERATIONS; i++) {
        crowd = i % 2 == 0 ? 0 : CROWD;
        for (uint32_t page_bytes = 1u; page_bytes <= 64u; page_bytes *= 2u) {
            for (uint32_t kind = 0u; kind < 4u; kind++) {
                cut_and_garble((operation_t)(i / 2), page_bytes, kind);
            }
        }
    }
}

/* The pages are cut again while what the first cut left is put in order. */
void test_a_power_cut_while_settling_does_no_harm(void)
{
    crowd = CROWD;
    for (int operation = SAVE_NEW; operation < OPERATIONS; operation++) {
        bool is_complete = false;
        for (int bytes = 0; !is_complete; bytes++) {
            bool is_settled = false;
            for (int more = 0; !is_settled; more++) {
                fill();
                operate((operation_t)operation);
                is_complete = store_rig_write_until(bytes);
                if (!is_complete) {
                    garble(64u, (uint32_t)bytes);
                }
                kinematics_store_mount(&store_rig_store, store_rig_memory);
                bool was_new = is_new((operation_t)operation);
                is_settled = store_rig_write_until(more);
                if (!is_settled) {
                    garble(64u, (uint32_t)more);
                }
                kinematics_store_mount(&store_rig_store, store_rig_memory);
                TEST_ASSERT_EQUAL(was_new, is_new((operation_t)operation));
                TEST_ASSERT_EQUAL(!was_new, is_old((operation_t)operation));
            }
        }
    }
}
