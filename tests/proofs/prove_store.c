/*
 * The store of kinematics with one record, in any state, whatever its slots are, full, damaged and
 * foreign ones among them: whatever is called next stays in bounds, a write lies in the memory,
 * nothing is written or answered where the memory cannot be used, and the state stays possible.
 * What kinematics_slots.h promises of the slots is believed here; prove_slots.c proves it.
 */
/* LINK: firmware/cycle/kinematics_store.c firmware/cycle/kinematics_writes.c
 * firmware/cycle/kinematics_slots.c firmware/cycle/kinematics_designation.c
 * firmware/report/latch_crc.c */
/* SED: firmware/cycle/kinematics_slots.c: s/_slots_\([a-z_]*\)(/_real_slots_\1(/ */
/* CBMC: -DKINEMATICS_STORE_RECORDS=1 -DKINEMATICS_STORE_PAYLOAD_MAX=1
 * -DKINEMATICS_STORE_PAGE_BYTES=8 -DKINEMATICS_STORE_NAME_MAX=4 --unwind 17 --unwindset main.0:73
 * --object-bits 12 */
/* MUTANT: firmware/cycle/kinematics_writes.c: if (store->slot == NO_SLOT) { => if (false) { */
/* MUTANT: firmware/cycle/kinematics_store.c: length > KINEMATICS_STORE_PAYLOAD_MAX) => false) */
/* MUTANT: firmware/cycle/kinematics_writes.c: while (turn < SETTLED && => while ( */
/* MUTANT: firmware/cycle/kinematics_writes.c: store->written == store->image_length =>
 * store->written > store->image_length */
/* MUTANT: firmware/cycle/kinematics_store.c: if (slots->damaged != 0u) => if (false) */
#include "any.h"
#include "cycle/kinematics_store.h"
#include "cycle/kinematics_writes.h"

static uint8_t            memory[KINEMATICS_STORE_BYTES];
static kinematics_store_t store;

/* ---- what is believed of the slots ---- */

static bool has(uint32_t bits, uint8_t slot)
{
    return (bits >> slot & 1u) != 0u;
}

static uint32_t valid;
static uint32_t damaged;
static bool     is_own;

/* For one memory: it does not change within a call. */
static void choose_slots(void)
{
    valid = nondet_u32();
    damaged = nondet_u32();
    is_own = nondet_bool();
    ASSUME((valid & damaged) == 0u && (valid | damaged) >> KINEMATICS_STORE_SLOTS == 0u);
    for (uint8_t i = 0u; i < KINEMATICS_STORE_SLOTS; i++) {
        uint32_t length = kinematics_slot_get(kinematics_slot_at(memory, i) + AT_LENGTH, 2u);
        ASSUME(IMPLIES(has(valid, i), length >= 1u && length <= KINEMATICS_STORE_PAYLOAD_MAX));
    }
}

kinematics_slots_t kinematics_slots_read(const uint8_t *bytes)
{
    return (kinematics_slots_t){bytes, valid, damaged};
}

uint8_t kinematics_slots_newest(const kinematics_slots_t       *slots,
                                const kinematics_designation_t *designation)
{
    uint8_t slot = nondet_u8();
    (void)designation;
    ASSUME(slot <= NO_SLOT && IMPLIES(slot < NO_SLOT, has(slots->valid, slot)));
    return slot;
}

bool kinematics_slots_count(const kinematics_slots_t *slots, uint8_t slot)
{
    PROVE(slot < KINEMATICS_STORE_SLOTS);
    return nondet_bool() && has(slots->valid, slot);
}

bool kinematics_slots_are_own(const kinematics_slots_t *slots)
{
    (void)slots;
    return is_own;
}

uint8_t kinematics_slots_free(const kinematics_slots_t *slots)
{
    uint8_t slot = nondet_u8();
    ASSUME(slot <= NO_SLOT && IMPLIES(slot < NO_SLOT, !has(slots->valid | slots->damaged, slot)));
    return slot;
}

/* ---- what is proved ---- */

/* What the module can have made of it. */
static bool is_possible(void)
{
    bool is_writing = store.step == STEP_BODY || store.step == STEP_MARK;
    bool is_body = store.step == STEP_BODY;
    return store.step <= STEP_DELETE && store.replaced <= NO_SLOT &&
           IMPLIES(store.step != STEP_IDLE, store.turn <= SETTLED) &&
           IMPLIES(is_writing, store.slot < KINEMATICS_STORE_SLOTS) &&
           IMPLIES(is_body, store.image_length <= sizeof store.image) &&
           IMPLIES(is_body, store.written < store.image_length) &&
           IMPLIES(store.step == STEP_DELETE, store.replaced < KINEMATICS_STORE_SLOTS);
}

static void call_any(bool is_usable)
{
    kinematics_designation_t designation;
    kinematics_record_t      record;
    double                   mode;
    uint8_t                  payload[KINEMATICS_STORE_PAYLOAD_MAX + 1u];
    uint16_t                 length = nondet_u16();
    uint8_t                  call = nondet_u8();

    for (uint8_t i = 0u; i < sizeof designation.bytes; i++) {
        designation.bytes[i] = nondet_u8();
    }
    if (call == 0u) {
        kinematics_store_mount(&store, memory);
        PROVE(IMPLIES(!is_usable, store.step == STEP_IDLE));
    } else if (call == 1u) {
        PROVE(IMPLIES(kinematics_store_activate(&store, payload, length) == KINEMATICS_STORE_OK,
                      is_usable && length <= KINEMATICS_STORE_PAYLOAD_MAX));
    } else if (call == 2u) {
        PROVE(IMPLIES(kinematics_store_start(&store, mode, &designation) == KINEMATICS_STORE_OK,
                      is_usable));
    } else if (call == 3u) {
        (void)kinematics_store_discard_damaged(&store);
    } else if (kinematics_store_find(&store, &designation, &record)) {
        PROVE(is_usable && record.length >= 1u && record.length <= KINEMATICS_STORE_PAYLOAD_MAX);
        PROVE(record.payload >= memory && record.payload < memory + KINEMATICS_STORE_BYTES);
    }
}

int main(void)
{
    kinematics_store_write_t write;
    for (uint8_t i = 0u; i < KINEMATICS_STORE_BYTES; i++) {
        memory[i] = nondet_u8();
    }
    kinematics_store_t any;
    store = any;
    store.memory = memory;
    ASSUME(is_possible());
    choose_slots();
    if (nondet_bool()) {
        call_any(damaged == 0u && is_own);
    } else if (kinematics_store_next_write(&store, &write)) {
        PROVE(write.length >= 1u && write.length <= KINEMATICS_STORE_WRITE_MAX);
        PROVE(write.offset <= KINEMATICS_STORE_BYTES - write.length);
    }
    PROVE(is_possible());
    return 0;
}
