#include "cycle/kinematics_slots.h"

#include <string.h>

#include "report/latch_crc.h"

uint32_t slot_offset(uint8_t slot)
{
    return (uint32_t)slot * KINEMATICS_STORE_SLOT_BYTES;
}

const uint8_t *slot_at(const uint8_t *memory, uint8_t slot)
{
    return memory + slot_offset(slot);
}

uint32_t slot_get(const uint8_t *bytes, uint8_t count)
{
    uint32_t value = 0u;
    while (count-- > 0u) {
        value = value << 8 | bytes[count];
    }
    return value;
}

void slot_put(uint8_t *bytes, uint8_t count, uint32_t value)
{
    for (uint8_t i = 0u; i < count; i++) {
        bytes[i] = (uint8_t)(value >> 8u * i & 0xFFu);
    }
}

uint16_t slot_checksum(const uint8_t *slot, uint16_t payload_length)
{
    return latch_crc_update(LATCH_CRC_START, slot + AT_SERIAL,
                            (size_t)(AT_PAYLOAD - AT_SERIAL) + payload_length);
}

static bool slot_is_valid(const uint8_t *memory, uint8_t index)
{
    const uint8_t *slot = slot_at(memory, index);
    uint16_t       length = (uint16_t)slot_get(slot + AT_LENGTH, 2u);

    return slot[AT_MARK] == VALID && length > 0u && length <= KINEMATICS_STORE_PAYLOAD_MAX &&
           slot_get(slot + AT_CHECKSUM, 2u) == slot_checksum(slot, length);
}

bool slot_is_of(const uint8_t *slot, const kinematics_designation_t *designation)
{
    return memcmp(slot + AT_DESIGNATION, designation->bytes, sizeof designation->bytes) == 0;
}

/* Serial numbers wrap; those in a store lie close together. */
static bool is_newer(const uint8_t *slot, const uint8_t *other)
{
    uint32_t ahead = slot_get(slot + AT_SERIAL, 4u) - slot_get(other + AT_SERIAL, 4u);
    return ahead != 0u && ahead < 0x80000000u;
}

uint8_t slot_newest(const uint8_t *memory, const kinematics_designation_t *designation)
{
    uint8_t found = NO_SLOT;
    for (uint8_t i = 0u; i < KINEMATICS_STORE_SLOTS; i++) {
        const uint8_t *slot = slot_at(memory, i);
        bool           fits = designation == NULL || slot_is_of(slot, designation);
        if (fits && slot_is_valid(memory, i) &&
            (found == NO_SLOT || is_newer(slot, slot_at(memory, found)))) {
            found = i;
        }
    }
    return found;
}

kinematics_designation_t slot_designation(const uint8_t *memory, uint8_t slot)
{
    kinematics_designation_t designation;
    memcpy(designation.bytes, slot_at(memory, slot) + AT_DESIGNATION, sizeof designation.bytes);
    return designation;
}

bool slot_counts(const uint8_t *memory, uint8_t slot)
{
    if (!slot_is_valid(memory, slot)) {
        return false;
    }
    kinematics_designation_t designation = slot_designation(memory, slot);
    return slot_newest(memory, &designation) == slot;
}

uint8_t slot_outdated(const uint8_t *memory)
{
    uint8_t slot = 0u;
    while (slot < KINEMATICS_STORE_SLOTS &&
           (!slot_is_valid(memory, slot) || slot_counts(memory, slot))) {
        slot++;
    }
    return slot;
}

uint8_t slot_free(const uint8_t *memory)
{
    uint8_t slot = 0u;
    while (slot < KINEMATICS_STORE_SLOTS && slot_is_valid(memory, slot)) {
        slot++;
    }
    return slot;
}
