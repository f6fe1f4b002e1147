#include "store_rig.h"

#include <string.h>

#include "cycle/kinematics_slots.h"
#include "unity.h"

uint8_t            store_rig_memory[KINEMATICS_STORE_BYTES];
kinematics_store_t store_rig_store;
uint32_t           store_rig_cut_at;

void store_rig_set_up(void)
{
    memset(store_rig_memory, 0xFF, sizeof store_rig_memory);
    store_rig_mount();
}

void store_rig_mount(void)
{
    kinematics_store_mount(&store_rig_store, store_rig_memory);
    TEST_ASSERT_TRUE(store_rig_write_until(NEVER));
}

bool store_rig_write_until(int bytes)
{
    kinematics_store_write_t write;
    int                      more_writes = 4 * KINEMATICS_STORE_SLOTS;

    while (kinematics_store_next_write(&store_rig_store, &write)) {
        TEST_ASSERT_TRUE(more_writes-- > 0);
        TEST_ASSERT_TRUE(write.length > 0 && write.length <= KINEMATICS_STORE_WRITE_MAX);
        TEST_ASSERT_TRUE(write.offset + write.length <= KINEMATICS_STORE_BYTES);
        for (uint32_t i = 0u; i < write.length; i++) {
            if (bytes-- == 0) {
                store_rig_cut_at = write.offset + i;
                return false;
            }
            store_rig_memory[write.offset + i] = write.bytes[i];
        }
    }
    return true;
}

void store_rig_finish(kinematics_store_error_t error)
{
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_OK, error);
    TEST_ASSERT_TRUE(store_rig_write_until(NEVER));
}

kinematics_designation_t store_rig_number(uint32_t value)
{
    kinematics_designation_t designation;
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_OK, kinematics_store_number(&designation, value));
    return designation;
}

kinematics_designation_t store_rig_name(const char *text)
{
    kinematics_designation_t designation;
    TEST_ASSERT_EQUAL(KINEMATICS_STORE_OK, kinematics_store_name(&designation, text));
    return designation;
}

kinematics_store_error_t store_rig_start(kinematics_store_mode_t         mode,
                                         const kinematics_designation_t *designation)
{
    return kinematics_store_start(&store_rig_store, (double)mode, designation);
}

void store_rig_activate(const char *payload)
{
    store_rig_finish(kinematics_store_activate(&store_rig_store, (const uint8_t *)payload,
                                               (uint16_t)strlen(payload)));
}

void store_rig_save_as(kinematics_designation_t designation)
{
    store_rig_finish(store_rig_start(KINEMATICS_STORE_SAVE, &designation));
}

static bool is(bool found, const kinematics_record_t *record, const char *payload)
{
    return found && record->length == strlen(payload) &&
           memcmp(record->payload, payload, record->length) == 0;
}

bool store_rig_active_is(const char *payload)
{
    kinematics_record_t record;
    bool                found = kinematics_store_active(&store_rig_store, &record);
    return is(found, &record, payload);
}

bool store_rig_saved_is(kinematics_designation_t designation, const char *payload)
{
    kinematics_record_t record;
    bool                found = kinematics_store_find(&store_rig_store, &designation, &record);
    return is(found, &record, payload);
}

bool store_rig_is_saved(kinematics_designation_t designation)
{
    kinematics_record_t record;
    return kinematics_store_find(&store_rig_store, &designation, &record);
}

int store_rig_count(void)
{
    kinematics_record_t record;
    int                 records = 0;
    while (kinematics_store_show(&store_rig_store, (uint8_t)records, &record)) {
        records++;
    }
    return records;
}

uint8_t *store_rig_slot(uint8_t slot)
{
    return store_rig_memory + kinematics_slot_offset(slot);
}

void store_rig_close(uint8_t *slot)
{
    uint16_t length = (uint16_t)kinematics_slot_get(slot + AT_LENGTH, 2u);
    kinematics_slot_put(slot + AT_CHECKSUM, 2u, kinematics_slot_checksum(slot, length));
}

void store_rig_forge(uint8_t slot, uint32_t serial, const kinematics_designation_t *designation,
                     const char *payload)
{
    uint8_t *bytes = store_rig_slot(slot);
    memcpy(bytes, SLOT_MARK, SLOT_MARK_BYTES);
    kinematics_slot_put(bytes + AT_SERIAL, 4u, serial);
    memcpy(bytes + AT_DESIGNATION, designation->bytes, sizeof designation->bytes);
    kinematics_slot_put(bytes + AT_LENGTH, 2u, (uint32_t)strlen(payload));
    memcpy(bytes + AT_PAYLOAD, payload, strlen(payload));
    store_rig_close(bytes);
}
