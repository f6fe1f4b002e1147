/*
 * The slots that the store of kinematics is cut into: what stands where in one, and which of them
 * count. Only kinematics_store.c uses it. `memory` is that of the store. Task.
 */
#ifndef CYCLE_KINEMATICS_SLOTS_H
#define CYCLE_KINEMATICS_SLOTS_H

#include <stdbool.h>
#include <stdint.h>

#include "cycle/kinematics_store.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Of a slot: what stands where. Numbers lowest byte first. */
enum {
    AT_MARK = 0, /* VALID, or anything else; not under the checksum, as it is written alone */
    AT_CHECKSUM = 1,
    AT_SERIAL = 3,
    AT_DESIGNATION = 7,
    AT_LENGTH = AT_DESIGNATION + 1 + KINEMATICS_STORE_NAME_MAX,
    AT_PAYLOAD = AT_LENGTH + 2
};

enum { VALID = 0xA5, WIPED = 0x00 };

#define NO_SLOT KINEMATICS_STORE_SLOTS

/* Where a slot begins in the memory, and its bytes. */
uint32_t       slot_offset(uint8_t slot);
const uint8_t *slot_at(const uint8_t *memory, uint8_t slot);

/* Numbers of `count` bytes, lowest first. */
uint32_t slot_get(const uint8_t *bytes, uint8_t count);
void     slot_put(uint8_t *bytes, uint8_t count, uint32_t value);

/* Of a slot's bytes, or their image, from AT_SERIAL to the end of the payload. */
uint16_t slot_checksum(const uint8_t *slot, uint16_t payload_length);

bool slot_is_of(const uint8_t *slot, const kinematics_designation_t *designation);
kinematics_designation_t slot_designation(const uint8_t *memory, uint8_t slot);

/* The newest valid slot of a designation, of any with NULL; NO_SLOT if there is none. */
uint8_t slot_newest(const uint8_t *memory, const kinematics_designation_t *designation);

/* Whether it is valid and the newest of its designation. */
bool slot_counts(const uint8_t *memory, uint8_t slot);

/* A valid slot that a newer one has taken the place of; NO_SLOT if there is none. */
uint8_t slot_outdated(const uint8_t *memory);

/* A slot that may be written into; there always is one. */
uint8_t slot_free(const uint8_t *memory);

#ifdef __cplusplus
}
#endif

#endif
