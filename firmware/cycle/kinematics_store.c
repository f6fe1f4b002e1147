#include "cycle/kinematics_store.h"

#include <string.h>

#include "cycle/kinematics_slots.h"

enum { STEP_IDLE, STEP_SETTLE, STEP_BODY, STEP_MARK, STEP_WIPE, STEP_DELETE };

#define SETTLED (2 * KINEMATICS_STORE_SLOTS)

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

static void read_slot(const uint8_t *slot, kinematics_record_t *record)
{
    record->designation = kinematics_slot_designation(slot);
    record->payload = slot + AT_PAYLOAD;
    record->length = (uint16_t)kinematics_slot_get(slot + AT_LENGTH, 2u);
}

bool kinematics_store_find(const kinematics_store_t       *store,
                           const kinematics_designation_t *designation, kinematics_record_t *record)
{
    kinematics_slots_t slots = kinematics_slots_read(store->memory);
    uint8_t            slot = kinematics_slots_newest(&slots, designation);
    if (slot == NO_SLOT || check(&slots) != KINEMATICS_STORE_OK) {
        return false;
    }
    read_slot(kinematics_slot_at(store->memory, slot), record);
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
            read_slot(kinematics_slot_at(store->memory, slot), record);
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

/* ---- writing ---- */

static kinematics_store_error_t plan_write(kinematics_store_t             *store,
                                           const kinematics_slots_t       *slots,
                                           const kinematics_designation_t *designation,
                                           const uint8_t *payload, uint16_t length)
{
    uint8_t *image = store->image;
    uint8_t  last = kinematics_slots_newest(slots, NULL);
    uint32_t serial =
        last == NO_SLOT
            ? 0u
            : kinematics_slot_get(kinematics_slot_at(slots->memory, last) + AT_SERIAL, 4u) + 1u;

    store->slot = kinematics_slots_free(slots);
    store->replaced = kinematics_slots_newest(slots, designation);
    if (store->slot == NO_SLOT) {
        return KINEMATICS_STORE_ERR_FULL;
    }
    memmove(image + AT_PAYLOAD, payload, length);
    kinematics_slot_put(image + AT_SERIAL, 4u, serial);
    memcpy(image + AT_DESIGNATION, designation->bytes, sizeof designation->bytes);
    kinematics_slot_put(image + AT_LENGTH, 2u, length);
    kinematics_slot_put(image + AT_CHECKSUM, 2u, kinematics_slot_checksum(image, length));
    store->image_length = (uint16_t)(AT_PAYLOAD + length);
    store->written = AT_CHECKSUM;
    store->step = STEP_BODY;
    return KINEMATICS_STORE_OK;
}

static void write_mark(kinematics_store_write_t *write, uint8_t slot, const uint8_t *mark)
{
    write->offset = kinematics_slot_offset(slot) + AT_MARK;
    write->length = SLOT_MARK_BYTES;
    memcpy(write->bytes, mark, SLOT_MARK_BYTES);
}

static bool write_body(kinematics_store_t *store, kinematics_store_write_t *write)
{
    uint16_t left = (uint16_t)(store->image_length - store->written);
    uint8_t  length =
        (uint8_t)(left < KINEMATICS_STORE_WRITE_MAX ? left : KINEMATICS_STORE_WRITE_MAX);

    write->length = length;
    write->offset = kinematics_slot_offset(store->slot) + store->written;
    memcpy(write->bytes, store->image + store->written, length);
    store->written = (uint16_t)(store->written + length);
    if (store->written == store->image_length) {
        store->step = STEP_MARK;
    }
    return true;
}

/* Twice round: first every mark goes that is in the way of a copy, then copies are made. */
static bool is_due(const kinematics_slots_t *slots, uint8_t turn)
{
    uint8_t        slot = (uint8_t)(turn % KINEMATICS_STORE_SLOTS);
    bool           counts = kinematics_slots_count(slots, slot);
    const uint8_t *mark = counts ? SLOT_MARK : SLOT_WIPED;
    return counts == (turn >= KINEMATICS_STORE_SLOTS) &&
           memcmp(kinematics_slot_at(slots->memory, slot) + AT_MARK, mark, SLOT_MARK_BYTES) != 0;
}

static uint8_t next_due(const kinematics_slots_t *slots, uint8_t turn)
{
    while (turn < SETTLED && !is_due(slots, turn)) {
        turn++;
    }
    return turn;
}

/* A mark in which bits are wrong is not mended in place, where a power cut could take the rest. */
static bool copy(kinematics_store_t *store, const kinematics_slots_t *slots, uint8_t slot,
                 kinematics_store_write_t *write)
{
    kinematics_record_t record;
    read_slot(kinematics_slot_at(slots->memory, slot), &record);
    return plan_write(store, slots, &record.designation, record.payload, record.length) ==
               KINEMATICS_STORE_OK &&
           write_body(store, write);
}

static bool settle_next(kinematics_store_t *store, kinematics_store_write_t *write)
{
    kinematics_slots_t slots = kinematics_slots_read(store->memory);
    uint8_t            turn = next_due(&slots, store->turn);
    store->turn = (uint8_t)(turn + 1u);
    store->step = STEP_IDLE;
    if (turn >= SETTLED) {
        return false;
    }
    if (turn >= KINEMATICS_STORE_SLOTS) {
        return copy(store, &slots, (uint8_t)(turn - KINEMATICS_STORE_SLOTS), write);
    }
    write_mark(write, turn, SLOT_WIPED);
    store->step = STEP_SETTLE;
    return true;
}

/* What has been replaced goes only once what replaces it can be read. */
static bool wipe_replaced(kinematics_store_t *store, kinematics_store_write_t *write)
{
    kinematics_slots_t slots = kinematics_slots_read(store->memory);
    if (store->replaced == NO_SLOT || kinematics_slots_count(&slots, store->replaced)) {
        return settle_next(store, write);
    }
    write_mark(write, store->replaced, SLOT_WIPED);
    store->step = STEP_SETTLE;
    return true;
}

bool kinematics_store_next_write(kinematics_store_t *store, kinematics_store_write_t *write)
{
    switch (store->step) {
    case STEP_SETTLE:
        return settle_next(store, write);
    case STEP_BODY:
        return write_body(store, write);
    case STEP_MARK:
        write_mark(write, store->slot, SLOT_MARK);
        store->step = STEP_WIPE;
        return true;
    case STEP_WIPE:
        return wipe_replaced(store, write);
    case STEP_DELETE:
        write_mark(write, store->replaced, SLOT_WIPED);
        store->step = STEP_IDLE;
        return true;
    case STEP_IDLE:
    default:
        return false;
    }
}

/* ---- operations ---- */

static void settle(kinematics_store_t *store, const kinematics_slots_t *slots)
{
    store->turn = next_due(slots, 0u);
    store->step = store->turn == SETTLED ? STEP_IDLE : STEP_SETTLE;
}

void kinematics_store_mount(kinematics_store_t *store, const uint8_t *memory)
{
    memset(store, 0, sizeof *store);
    store->memory = memory;
    kinematics_slots_t slots = kinematics_slots_read(memory);
    if (check(&slots) == KINEMATICS_STORE_OK) {
        settle(store, &slots);
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
    settle(store, &slots);
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
    return plan_write(store, &slots, &ACTIVE, payload, length);
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
    read_slot(kinematics_slot_at(slots->memory, from), &active);
    return plan_write(store, slots, designation, active.payload, active.length);
}

static kinematics_store_error_t restore(kinematics_store_t *store, const kinematics_slots_t *slots,
                                        const kinematics_designation_t *designation)
{
    kinematics_record_t saved;
    uint8_t             from = kinematics_slots_newest(slots, designation);
    if (from == NO_SLOT) {
        return KINEMATICS_STORE_ERR_NOT_FOUND;
    }
    read_slot(kinematics_slot_at(slots->memory, from), &saved);
    return plan_write(store, slots, &ACTIVE, saved.payload, saved.length);
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
