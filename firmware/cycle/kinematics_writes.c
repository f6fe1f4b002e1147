#include "cycle/kinematics_writes.h"

#include <string.h>

kinematics_store_error_t kinematics_writes_plan(kinematics_store_t             *store,
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
    kinematics_slot_read(kinematics_slot_at(slots->memory, slot), &record);
    return kinematics_writes_plan(store, slots, &record.designation, record.payload,
                                  record.length) == KINEMATICS_STORE_OK &&
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

void kinematics_writes_settle(kinematics_store_t *store, const kinematics_slots_t *slots)
{
    store->turn = next_due(slots, 0u);
    store->step = store->turn == SETTLED ? STEP_IDLE : STEP_SETTLE;
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
