#include "cycle/kinematics_store.h"

#include <string.h>

#include "cycle/kinematics_slots.h"
#include "cycle/kinematics_writes.h"

static const kinematics_designation_t ACTIVE = {.bytes = {IS_ACTIVE}};

/* ---- reading ---- */

static kinematics_store_error_t check(const kinematics_slots_t *slots)
{
    if (slots->damaged != 0u) {
        return KINEMATICS_STORE_ERR_DAMAGED;
    }
    return kinematics_slots_are_own(slots) ? KINEMATICS_STORE_OK : KINEMATICS_STORE_ERR_FOREIGN;
}

kinematics_store_error_t kinematics_store_check(const kinematics_store_t *store)
{
    kinematics_slots_t slots = kinematics_slots_read(store->memory);
    return check(&slots);
}

bool kinematics_store_find(const kinematics_store_t       *store,
                           const kinematics_designation_t *designation, kinematics_record_t *record)
{
    kinematics_slots_t slots = kinematics_slots_read(store->memory);
    uint8_t            slot = kinematics_slots_newest(&slots, designation);
    if (slot == NO_SLOT || check(&slots) != KINEMATICS_STORE_OK) {
        return false;
    }
    kinematics_slot_read(kinematics_slot_at(store->memory, slot), record);
    return true;
}

bool kinematics_store_active(const kinematics_store_t *store, kinematics_record_t *record)
{
    return kinematics_store_find(store, &ACTIVE, record);
}

static bool is_record(const kinematics_slots_t *slots, uint8_t slot)
{
    return kinematics_slots_count(slots, slot) &&
           !kinematics_slot_is_of(kinematics_slot_at(slots->memory, slot), &ACTIVE);
}

bool kinematics_store_show(const kinematics_store_t *store, uint8_t index,
                           kinematics_record_t *record)
{
    kinematics_slots_t slots = kinematics_slots_read(store->memory);
    if (check(&slots) != KINEMATICS_STORE_OK) {
        return false;
    }
    for (uint8_t slot = 0u; slot < KINEMATICS_STORE_SLOTS; slot++) {
        if (is_record(&slots, slot) && index-- == 0u) {
            kinematics_slot_read(kinematics_slot_at(store->memory, slot), record);
            return true;
        }
    }
    return false;
}

static uint8_t count_records(const kinematics_slots_t *slots)
{
    uint8_t count = 0u;
    for (uint8_t slot = 0u; slot < KINEMATICS_STORE_SLOTS; slot++) {
        count = (uint8_t)(count + is_record(slots, slot));
    }
    return count;
}

/* ---- operations ---- */

void kinematics_store_mount(kinematics_store_t *store, const uint8_t *memory)
{
    memset(store, 0, sizeof *store);
    store->memory = memory;
    kinematics_slots_t slots = kinematics_slots_read(memory);
    if (check(&slots) == KINEMATICS_STORE_OK) {
        kinematics_writes_settle(store, &slots);
    }
}

kinematics_store_error_t kinematics_store_discard_damaged(kinematics_store_t *store)
{
    if (store->step != STEP_IDLE) {
        return KINEMATICS_STORE_ERR_BUSY;
    }
    kinematics_slots_t slots = kinematics_slots_read(store->memory);
    if (!kinematics_slots_are_own(&slots)) {
        return KINEMATICS_STORE_ERR_FOREIGN;
    }
    kinematics_writes_settle(store, &slots);
    return KINEMATICS_STORE_OK;
}

/* OK where an operation can begin. */
static kinematics_store_error_t begin(kinematics_store_t *store, kinematics_slots_t *slots)
{
    if (store->step != STEP_IDLE) {
        return KINEMATICS_STORE_ERR_BUSY;
    }
    *slots = kinematics_slots_read(store->memory);
    store->turn = SETTLED;
    return check(slots);
}

kinematics_store_error_t kinematics_store_activate(kinematics_store_t *store,
                                                   const uint8_t *payload, uint16_t length)
{
    kinematics_slots_t       slots;
    kinematics_store_error_t error = begin(store, &slots);
    if (error != KINEMATICS_STORE_OK) {
        return error;
    }
    if (length == 0u || length > KINEMATICS_STORE_PAYLOAD_MAX) {
        return KINEMATICS_STORE_ERR_LENGTH;
    }
    return kinematics_writes_plan(store, &slots, &ACTIVE, payload, length);
}

static kinematics_store_error_t save(kinematics_store_t *store, const kinematics_slots_t *slots,
                                     const kinematics_designation_t *designation)
{
    kinematics_record_t active;
    uint8_t             from = kinematics_slots_newest(slots, &ACTIVE);
    bool                is_new = kinematics_slots_newest(slots, designation) == NO_SLOT;

    if (is_new && count_records(slots) >= KINEMATICS_STORE_RECORDS) {
        return KINEMATICS_STORE_ERR_FULL;
    }
    if (from == NO_SLOT) {
        return KINEMATICS_STORE_ERR_NO_ACTIVE;
    }
    kinematics_slot_read(kinematics_slot_at(slots->memory, from), &active);
    return kinematics_writes_plan(store, slots, designation, active.payload, active.length);
}

static kinematics_store_error_t restore(kinematics_store_t *store, const kinematics_slots_t *slots,
                                        const kinematics_designation_t *designation)
{
    kinematics_record_t saved;
    uint8_t             from = kinematics_slots_newest(slots, designation);
    if (from == NO_SLOT) {
        return KINEMATICS_STORE_ERR_NOT_FOUND;
    }
    kinematics_slot_read(kinematics_slot_at(slots->memory, from), &saved);
    return kinematics_writes_plan(store, slots, &ACTIVE, saved.payload, saved.length);
}

static kinematics_store_error_t delete_saved(kinematics_store_t             *store,
                                             const kinematics_slots_t       *slots,
                                             const kinematics_designation_t *designation)
{
    store->replaced = kinematics_slots_newest(slots, designation);
    if (store->replaced == NO_SLOT) {
        return KINEMATICS_STORE_ERR_NOT_FOUND;
    }
    store->step = STEP_DELETE;
    return KINEMATICS_STORE_OK;
}

static bool is_mode(double mode, kinematics_store_mode_t wanted)
{
    double off = mode - (double)wanted;
    return off >= 0.0 && off <= 0.0;
}

kinematics_store_error_t kinematics_store_start(kinematics_store_t *store, double mode,
                                                const kinematics_designation_t *designation)
{
    kinematics_slots_t       slots;
    kinematics_store_error_t error = begin(store, &slots);
    if (error != KINEMATICS_STORE_OK || is_mode(mode, KINEMATICS_STORE_SHOW)) {
        return error;
    }
    bool is_restoring = is_mode(mode, KINEMATICS_STORE_RESTORE);
    bool is_deletion = is_mode(mode, KINEMATICS_STORE_DELETE);
    if (!is_restoring && !is_deletion && !is_mode(mode, KINEMATICS_STORE_SAVE)) {
        return KINEMATICS_STORE_ERR_MODE;
    }
    if (designation->bytes[0] == IS_ACTIVE || !kinematics_designation_is_own(designation)) {
        return KINEMATICS_STORE_ERR_DESIGNATION;
    }
    if (is_restoring) {
        return restore(store, &slots, designation);
    }
    return is_deletion ? delete_saved(store, &slots, designation)
                       : save(store, &slots, designation);
}
