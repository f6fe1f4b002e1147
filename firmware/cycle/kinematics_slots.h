/*
 * The slots that the store of kinematics is cut into: what stands where in one, and which of them
 * count. Only the sources of the store use it. `memory` is that of the store. Task.
 *
 * A slot is a page with the mark and then the pages of the record. The mark is a pattern of its
 * own: eight of its 64 bits may be wrong. What a power cut leaves in a mark is no mark but once in
 * 10^9 times, and then only before a record that was written whole. So a mark before a wrong
 * checksum is no power cut: the memory has lost bits.
 */
#ifndef CYCLE_KINEMATICS_SLOTS_H
#define CYCLE_KINEMATICS_SLOTS_H

#include <stdbool.h>
#include <stdint.h>

#include "cycle/kinematics_store.h"

#ifdef __cplusplus
extern "C" {
#endif

#define SLOT_MARK_BYTES 8

/* Of a slot: what stands where. Numbers lowest byte first. */
enum {
    AT_MARK = 0, /* SLOT_MARK, or anything else; the only thing on its page */
    AT_CHECKSUM = KINEMATICS_STORE_PAGE_BYTES,
    AT_SERIAL = AT_CHECKSUM + 2,
    AT_DESIGNATION = AT_SERIAL + 4,
    AT_LENGTH = AT_DESIGNATION + 1 + KINEMATICS_STORE_NAME_MAX,
    AT_PAYLOAD = AT_LENGTH + 2
};

enum { IS_ACTIVE, IS_NUMBER, IS_NAME }; /* first byte of a designation */

#define NO_SLOT KINEMATICS_STORE_SLOTS

/* Whether a designation is one that kinematics_store_number() or _name() makes, or the active one.
 */
bool kinematics_designation_is_own(const kinematics_designation_t *designation);

/* What stands before a record that counts, and what is written over it to wipe it. */
extern const uint8_t SLOT_MARK[SLOT_MARK_BYTES];
extern const uint8_t SLOT_WIPED[SLOT_MARK_BYTES];

/* Where a slot begins in the memory, and its bytes. */
uint32_t       kinematics_slot_offset(uint8_t slot);
const uint8_t *kinematics_slot_at(const uint8_t *memory, uint8_t slot);

/* Numbers of `count` bytes, lowest first. */
uint32_t kinematics_slot_get(const uint8_t *bytes, uint8_t count);
void     kinematics_slot_put(uint8_t *bytes, uint8_t count, uint32_t value);

/* Of a slot's bytes, or their image, from AT_SERIAL to the end of the payload. */
uint16_t kinematics_slot_checksum(const uint8_t *slot, uint16_t payload_length);

bool kinematics_slot_is_of(const uint8_t *slot, const kinematics_designation_t *designation);
kinematics_designation_t kinematics_slot_designation(const uint8_t *slot);

/* The record in a slot's bytes. */
void kinematics_slot_read(const uint8_t *slot, kinematics_record_t *record);

/* What the slots are, a bit each: read once, for all that is asked about them. */
typedef struct {
    const uint8_t *memory;
    uint32_t       valid;   /* bears the mark, and the checksum is right */
    uint32_t       damaged; /* bears the mark, and the checksum is wrong */
} kinematics_slots_t;

kinematics_slots_t kinematics_slots_read(const uint8_t *memory);

/*
 * Whether what the valid slots say can have been written by this store: designations as it makes
 * them, no two that are equally new, and one slot to spare for the next write.
 */
bool kinematics_slots_are_own(const kinematics_slots_t *slots);

/* The newest valid slot of a designation, of any with NULL; NO_SLOT if there is none. */
uint8_t kinematics_slots_newest(const kinematics_slots_t       *slots,
                                const kinematics_designation_t *designation);

/* Whether it is valid and the newest of its designation. */
bool kinematics_slots_count(const kinematics_slots_t *slots, uint8_t slot);

/* A slot without a mark, which may be written into; NO_SLOT if there is none. */
uint8_t kinematics_slots_free(const kinematics_slots_t *slots);

#ifdef __cplusplus
}
#endif

#endif
