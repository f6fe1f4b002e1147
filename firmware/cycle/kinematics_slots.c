#include "cycle/kinematics_slots.h"

#include <string.h>

#include "report/latch_crc.h"

#define WRONG_BITS_MAX 8u /* of a mark's 64 */

/* As far from all zeros as from all ones, and no two bytes alike. */
const uint8_t SLOT_MARK[SLOT_MARK_BYTES] = {0xA5u, 0x1Eu, 0x93u, 0x6Cu, 0xD2u, 0x39u, 0x47u, 0xB8u};
const uint8_t SLOT_WIPED[SLOT_MARK_BYTES] = {0u};

uint32_t kinematics_slot_offset(uint8_t slot)
{
    return (uint32_t)slot * KINEMATICS_STORE_SLOT_BYTES;
}

const uint8_t *kinematics_slot_at(const uint8_t *memory, uint8_t slot)
{
    return memory + kinematics_slot_offset(slot);
}

uint32_t kinematics_slot_get(const uint8_t *bytes, uint8_t count)
{
    uint32_t value = 0u;
    while (count-- > 0u) {
        value = value << 8 | bytes[count];
    }
    return value;
}

void kinematics_slot_put(uint8_t *bytes, uint8_t count, uint32_t value)
{
    for (uint8_t i = 0u; i < count; i++) {
        bytes[i] = (uint8_t)(value >> 8u * i & 0xFFu);
    }
}

uint16_t kinematics_slot_checksum(const uint8_t *slot, uint16_t payload_length)
{
    return latch_crc_update(LATCH_CRC_START, slot + AT_SERIAL,
                            (size_t)(AT_PAYLOAD - AT_SERIAL) + payload_length);
}

static uint8_t different_bits(const uint8_t *slot)
{
    uint8_t count = 0u;
    for (uint8_t i = 0u; i < SLOT_MARK_BYTES; i++) {
        uint32_t wrong = (uint32_t)slot[AT_MARK + i] ^ SLOT_MARK[i];
        for (; wrong != 0u; wrong &= wrong - 1u) {
            count++;
        }
    }
    return count;
}

static bool is_sound(const uint8_t *slot)
{
    uint16_t length = (uint16_t)kinematics_slot_get(slot + AT_LENGTH, 2u);
    return length > 0u && length <= KINEMATICS_STORE_PAYLOAD_MAX &&
           kinematics_slot_get(slot + AT_CHECKSUM, 2u) == kinematics_slot_checksum(slot, length);
}

bool kinematics_slot_is_of(const uint8_t *slot, const kinematics_designation_t *designation)
{
    return memcmp(slot + AT_DESIGNATION, designation->bytes, sizeof designation->bytes) == 0;
}

kinematics_designation_t kinematics_slot_designation(const uint8_t *slot)
{
    kinematics_designation_t designation;
    memcpy(designation.bytes, slot + AT_DESIGNATION, sizeof designation.bytes);
    return designation;
}

void kinematics_slot_read(const uint8_t *slot, kinematics_record_t *record)
{
    record->designation = kinematics_slot_designation(slot);
    record->payload = slot + AT_PAYLOAD;
    record->length = (uint16_t)kinematics_slot_get(slot + AT_LENGTH, 2u);
}

/* ---- all of them ---- */

static uint32_t bit(uint8_t slot)
{
    return (uint32_t)1u << slot;
}

kinematics_slots_t kinematics_slots_read(const uint8_t *memory)
{
    kinematics_slots_t slots = {.memory = memory};
    for (uint8_t i = 0u; i < KINEMATICS_STORE_SLOTS; i++) {
        const uint8_t *slot = kinematics_slot_at(memory, i);
        if (different_bits(slot) <= WRONG_BITS_MAX) {
            *(is_sound(slot) ? &slots.valid : &slots.damaged) |= bit(i);
        }
    }
    return slots;
}

/* Serial numbers wrap; those in a store lie close together. */
static bool is_newer(const uint8_t *slot, const uint8_t *other)
{
    uint32_t ahead =
        kinematics_slot_get(slot + AT_SERIAL, 4u) - kinematics_slot_get(other + AT_SERIAL, 4u);
    return ahead != 0u && ahead < 0x80000000u;
}

uint8_t kinematics_slots_newest(const kinematics_slots_t       *slots,
                                const kinematics_designation_t *designation)
{
    uint8_t found = NO_SLOT;
    for (uint8_t i = 0u; i < KINEMATICS_STORE_SLOTS; i++) {
        const uint8_t *slot = kinematics_slot_at(slots->memory, i);
        bool           fits = designation == NULL || kinematics_slot_is_of(slot, designation);
        if ((slots->valid & bit(i)) != 0u && fits &&
            (found == NO_SLOT || is_newer(slot, kinematics_slot_at(slots->memory, found)))) {
            found = i;
        }
    }
    return found;
}

bool kinematics_slots_count(const kinematics_slots_t *slots, uint8_t slot)
{
    kinematics_designation_t designation =
        kinematics_slot_designation(kinematics_slot_at(slots->memory, slot));
    return (slots->valid & bit(slot)) != 0u && kinematics_slots_newest(slots, &designation) == slot;
}

uint8_t kinematics_slots_free(const kinematics_slots_t *slots)
{
    uint8_t slot = 0u;
    while (slot < KINEMATICS_STORE_SLOTS && ((slots->valid | slots->damaged) & bit(slot)) != 0u) {
        slot++;
    }
    return slot;
}

/* ---- whose they are ---- */

/* Of two with the same designation one has to be the newer one. */
static bool is_in_order(const kinematics_slots_t *slots, uint8_t index)
{
    const uint8_t           *slot = kinematics_slot_at(slots->memory, index);
    kinematics_designation_t designation = kinematics_slot_designation(slot);
    for (uint8_t i = 0u; i < index; i++) {
        const uint8_t *other = kinematics_slot_at(slots->memory, i);
        if ((slots->valid & bit(i)) != 0u && kinematics_slot_is_of(other, &designation) &&
            !is_newer(slot, other) && !is_newer(other, slot)) {
            return false;
        }
    }
    return true;
}

bool kinematics_slots_are_own(const kinematics_slots_t *slots)
{
    uint8_t counting = 0u;
    for (uint8_t i = 0u; i < KINEMATICS_STORE_SLOTS; i++) {
        kinematics_designation_t designation =
            kinematics_slot_designation(kinematics_slot_at(slots->memory, i));
        if ((slots->valid & bit(i)) != 0u &&
            (!kinematics_designation_is_own(&designation) || !is_in_order(slots, i))) {
            return false;
        }
        counting = (uint8_t)(counting + kinematics_slots_count(slots, i));
    }
    return counting < KINEMATICS_STORE_SLOTS;
}
