#include "cycle/kinematics_store.h"

#include <string.h>

#include "cycle/kinematics_slots.h"

enum { IS_ACTIVE, IS_NUMBER, IS_NAME }; /* first byte of a designation */
enum { STEP_IDLE, STEP_CLEAN, STEP_BODY, STEP_MARK, STEP_DELETE };

static const kinematics_designation_t ACTIVE = {.bytes = {IS_ACTIVE}};

/* ---- reading ---- */

static bool read_slot(const kinematics_store_t *store, uint8_t slot, kinematics_record_t *record)
{
    if (slot == NO_SLOT) {
        return false;
    }
    record->designation = slot_designation(store->memory, slot);
    record->payload = slot_at(store->memory, slot) + AT_PAYLOAD;
    record->length = (uint16_t)slot_get(slot_at(store->memory, slot) + AT_LENGTH, 2u);
    return true;
}

bool kinematics_store_active(const kinematics_store_t *store, kinematics_record_t *record)
{
    return read_slot(store, slot_newest(store->memory, &ACTIVE), record);
}

bool kinematics_store_find(const kinematics_store_t       *store,
                           const kinematics_designation_t *designation, kinematics_record_t *record)
{
    return read_slot(store, slot_newest(store->memory, designation), record);
}

bool kinematics_store_show(const kinematics_store_t *store, uint8_t index,
                           kinematics_record_t *record)
{
    for (uint8_t slot = 0u; slot < KINEMATICS_STORE_SLOTS; slot++) {
        bool is_record =
            slot_counts(store->memory, slot) && !slot_is_of(slot_at(store->memory, slot), &ACTIVE);
        if (is_record && index-- == 0u) {
            return read_slot(store, slot, record);
        }
    }
    return false;
}

static uint8_t records(const kinematics_store_t *store)
{
    kinematics_record_t record;
    uint8_t             count = 0u;
    while (kinematics_store_show(store, count, &record)) {
        count++;
    }
    return count;
}

/* ---- designations ---- */

kinematics_store_error_t kinematics_store_number(kinematics_designation_t *designation,
                                                 double                    number)
{
    bool is_sound = number >= 0.0 && number <= KINEMATICS_STORE_NUMBER_MAX;
    if (!is_sound || number - (double)(uint32_t)number > 0.0) {
        return KINEMATICS_STORE_ERR_DESIGNATION;
    }
    memset(designation, 0, sizeof *designation);
    designation->bytes[0] = IS_NUMBER;
    slot_put(designation->bytes + 1, 4u, (uint32_t)number);
    return KINEMATICS_STORE_OK;
}

kinematics_store_error_t kinematics_store_name(kinematics_designation_t *designation,
                                               const char               *name)
{
    uint8_t length = 0u;

    while (length <= KINEMATICS_STORE_NAME_MAX && name[length] != '\0') {
        if (name[length] <= ' ' || name[length] > '~') {
            return KINEMATICS_STORE_ERR_DESIGNATION;
        }
        length++;
    }
    if (length == 0u || length > KINEMATICS_STORE_NAME_MAX) {
        return KINEMATICS_STORE_ERR_DESIGNATION;
    }
    memset(designation, 0, sizeof *designation);
    designation->bytes[0] = IS_NAME;
    memcpy(designation->bytes + 1, name, length);
    return KINEMATICS_STORE_OK;
}

static void write_number(uint32_t number, char *text)
{
    uint8_t length = 1u;
    for (uint32_t rest = number; rest > 9u; rest /= 10u) {
        length++;
    }
    text[length] = '\0';
    while (length-- > 0u) {
        text[length] = (char)('0' + number % 10u);
        number /= 10u;
    }
}

void kinematics_store_text(const kinematics_designation_t *designation, char *text)
{
    if (designation->bytes[0] == IS_NUMBER) {
        write_number(slot_get(designation->bytes + 1, 4u), text);
    } else {
        memcpy(text, designation->bytes + 1, KINEMATICS_STORE_NAME_MAX);
        text[KINEMATICS_STORE_NAME_MAX] = '\0';
    }
}

/* ---- writing ---- */

static void plan_write(kinematics_store_t *store, const kinematics_designation_t *designation,
                       const uint8_t *payload, uint16_t length)
{
    uint8_t *image = store->image;
    uint8_t  last = slot_newest(store->memory, NULL);
    uint32_t serial =
        last == NO_SLOT ? 0u : slot_get(slot_at(store->memory, last) + AT_SERIAL, 4u) + 1u;

    memmove(image + AT_PAYLOAD, payload, length);
    slot_put(image + AT_SERIAL, 4u, serial);
    memcpy(image + AT_DESIGNATION, designation->bytes, sizeof designation->bytes);
    slot_put(image + AT_LENGTH, 2u, length);
    slot_put(image + AT_CHECKSUM, 2u, slot_checksum(image, length));
    store->image_length = (uint16_t)(AT_PAYLOAD + length);
    store->written = AT_CHECKSUM;
    store->step = STEP_CLEAN;
}

static void write_byte(kinematics_store_write_t *write, uint8_t slot, uint8_t mark)
{
    write->offset = slot_offset(slot) + AT_MARK;
    write->length = 1u;
    write->bytes[0] = mark;
}

static bool wipe_outdated(const kinematics_store_t *store, kinematics_store_write_t *write)
{
    uint8_t slot = slot_outdated(store->memory);
    if (slot == NO_SLOT) {
        return false;
    }
    write_byte(write, slot, WIPED);
    return true;
}

static void write_body(kinematics_store_t *store, kinematics_store_write_t *write)
{
    uint16_t left = (uint16_t)(store->image_length - store->written);
    uint8_t  length =
        (uint8_t)(left < KINEMATICS_STORE_WRITE_MAX ? left : KINEMATICS_STORE_WRITE_MAX);

    write->length = length;
    write->offset = slot_offset(store->slot) + store->written;
    memcpy(write->bytes, store->image + store->written, length);
    store->written = (uint16_t)(store->written + length);
    if (store->written == store->image_length) {
        store->step = STEP_MARK;
    }
}

/* A slot with a broken checksum may still bear the mark: away with that before it is filled. */
static bool unmark(kinematics_store_t *store, kinematics_store_write_t *write)
{
    store->slot = slot_free(store->memory);
    if (slot_at(store->memory, store->slot)[AT_MARK] != VALID) {
        return false;
    }
    write_byte(write, store->slot, WIPED);
    return true;
}

static bool begin_body(kinematics_store_t *store, kinematics_store_write_t *write)
{
    if (wipe_outdated(store, write) || unmark(store, write)) {
        return true;
    }
    store->step = STEP_BODY;
    write_body(store, write);
    return true;
}

/* The older ones first, or they would count again. */
static bool delete_next(kinematics_store_t *store, kinematics_store_write_t *write)
{
    if (wipe_outdated(store, write)) {
        return true;
    }
    uint8_t slot = slot_newest(store->memory, &store->doomed);
    store->step = STEP_IDLE;
    write_byte(write, slot, WIPED);
    return true;
}

bool kinematics_store_next_write(kinematics_store_t *store, kinematics_store_write_t *write)
{
    switch (store->step) {
    case STEP_CLEAN:
        return begin_body(store, write);
    case STEP_BODY:
        write_body(store, write);
        return true;
    case STEP_MARK:
        write_byte(write, store->slot, VALID);
        store->step = STEP_IDLE;
        return true;
    case STEP_DELETE:
        return delete_next(store, write);
    case STEP_IDLE:
    default:
        return false;
    }
}

/* ---- operations ---- */

void kinematics_store_mount(kinematics_store_t *store, const uint8_t *memory)
{
    memset(store, 0, sizeof *store);
    store->memory = memory;
}

kinematics_store_error_t kinematics_store_activate(kinematics_store_t *store,
                                                   const uint8_t *payload, uint16_t length)
{
    if (store->step != STEP_IDLE) {
        return KINEMATICS_STORE_ERR_BUSY;
    }
    if (length == 0u || length > KINEMATICS_STORE_PAYLOAD_MAX) {
        return KINEMATICS_STORE_ERR_LENGTH;
    }
    plan_write(store, &ACTIVE, payload, length);
    return KINEMATICS_STORE_OK;
}

static kinematics_store_error_t save(kinematics_store_t             *store,
                                     const kinematics_designation_t *designation)
{
    kinematics_record_t record;

    bool is_new = !kinematics_store_find(store, designation, &record);
    if (is_new && records(store) >= KINEMATICS_STORE_RECORDS) {
        return KINEMATICS_STORE_ERR_FULL;
    }
    if (!kinematics_store_active(store, &record)) {
        return KINEMATICS_STORE_ERR_NO_ACTIVE;
    }
    plan_write(store, designation, record.payload, record.length);
    return KINEMATICS_STORE_OK;
}

static kinematics_store_error_t restore_or_delete(kinematics_store_t             *store,
                                                  const kinematics_designation_t *designation,
                                                  bool                            is_deletion)
{
    kinematics_record_t record;

    if (!kinematics_store_find(store, designation, &record)) {
        return KINEMATICS_STORE_ERR_NOT_FOUND;
    }
    if (is_deletion) {
        store->doomed = *designation;
        store->step = STEP_DELETE;
        return KINEMATICS_STORE_OK;
    }
    return kinematics_store_activate(store, record.payload, record.length);
}

static bool is_mode(double mode, kinematics_store_mode_t wanted)
{
    double off = mode - (double)wanted;
    return off >= 0.0 && off <= 0.0;
}

kinematics_store_error_t kinematics_store_start(kinematics_store_t *store, double mode,
                                                const kinematics_designation_t *designation)
{
    if (store->step != STEP_IDLE) {
        return KINEMATICS_STORE_ERR_BUSY;
    }
    if (is_mode(mode, KINEMATICS_STORE_SHOW)) {
        return KINEMATICS_STORE_OK;
    }
    bool is_restoring = is_mode(mode, KINEMATICS_STORE_RESTORE);
    bool is_deletion = is_mode(mode, KINEMATICS_STORE_DELETE);
    if (!is_restoring && !is_deletion && !is_mode(mode, KINEMATICS_STORE_SAVE)) {
        return KINEMATICS_STORE_ERR_MODE;
    }
    uint8_t kind = designation->bytes[0];
    if (kind != IS_NUMBER && kind != IS_NAME) {
        return KINEMATICS_STORE_ERR_DESIGNATION;
    }
    return is_restoring || is_deletion ? restore_or_delete(store, designation, is_deletion)
                                       : save(store, designation);
}

const char *kinematics_store_phrase(kinematics_store_error_t error)
{
    static const char *const PHRASES[] = {
        [KINEMATICS_STORE_OK] = "no error",
        [KINEMATICS_STORE_ERR_MODE] = "Q410 MODE is not 0, 1, 2 or 3",
        [KINEMATICS_STORE_ERR_DESIGNATION] =
            "Q409 MEMORY DESIGNATION is no number from 0 to 99999 and no name of 16 characters",
        [KINEMATICS_STORE_ERR_NOT_FOUND] = "nothing is saved under Q409 MEMORY DESIGNATION",
        [KINEMATICS_STORE_ERR_FULL] = "all 16 places are taken",
        [KINEMATICS_STORE_ERR_NO_ACTIVE] = "there are no active kinematics to save",
        [KINEMATICS_STORE_ERR_LENGTH] = "the description is empty or too long",
        [KINEMATICS_STORE_ERR_BUSY] = "the operation before is not over",
    };
    return PHRASES[error];
}
