/*
 * The slots of the store of kinematics with one record, on any memory: what kinematics_slots.h
 * promises and prove_store.c believes. The newest slot and one that counts are valid, a free one
 * bears no mark, a valid one has a length in range, and a store that is its own has a slot to
 * spare.
 */
/* LINK: firmware/cycle/kinematics_slots.c firmware/cycle/kinematics_designation.c
 * firmware/report/latch_crc.c */
/* CBMC: -DKINEMATICS_STORE_RECORDS=1 -DKINEMATICS_STORE_PAYLOAD_MAX=1
 * -DKINEMATICS_STORE_PAGE_BYTES=8 -DKINEMATICS_STORE_NAME_MAX=4 --unwind 14 --unwindset main.0:73
 * --object-bits 12 */
/* MUTANT: firmware/cycle/kinematics_slots.c: bit(slot)) != 0u) { => bit(slot)) == 0u) { */
/* MUTANT: firmware/cycle/kinematics_slots.c: slots->valid | slots->damaged => slots->valid */
/* MUTANT: firmware/cycle/kinematics_slots.c: length <= KINEMATICS_STORE_PAYLOAD_MAX && => true &&
 */
/* MUTANT: firmware/cycle/kinematics_slots.c: (slots->valid & bit(i)) != 0u && fits => fits */
/* MUTANT: firmware/cycle/kinematics_slots.c: return counting < => return counting <= */
#include <stddef.h>

#include "any.h"
#include "cycle/kinematics_slots.h"

static uint8_t memory[KINEMATICS_STORE_BYTES];

static bool has(uint32_t bits, uint8_t slot)
{
    return (bits >> slot & 1u) != 0u;
}

static void prove_lengths(const kinematics_slots_t *slots)
{
    for (uint8_t i = 0u; i < KINEMATICS_STORE_SLOTS; i++) {
        uint32_t length = kinematics_slot_get(kinematics_slot_at(memory, i) + AT_LENGTH, 2u);
        PROVE(
            IMPLIES(has(slots->valid, i), length >= 1u && length <= KINEMATICS_STORE_PAYLOAD_MAX));
    }
}

int main(void)
{
    kinematics_designation_t designation;
    for (uint8_t i = 0u; i < KINEMATICS_STORE_BYTES; i++) {
        memory[i] = nondet_u8();
    }
    for (uint8_t i = 0u; i < sizeof designation.bytes; i++) {
        designation.bytes[i] = nondet_u8();
    }
    kinematics_slots_t slots = kinematics_slots_read(memory);
    PROVE((slots.valid & slots.damaged) == 0u);
    PROVE((slots.valid | slots.damaged) >> KINEMATICS_STORE_SLOTS == 0u);
    prove_lengths(&slots);

    uint8_t newest = kinematics_slots_newest(&slots, nondet_bool() ? &designation : NULL);
    PROVE(newest <= NO_SLOT && IMPLIES(newest < NO_SLOT, has(slots.valid, newest)));
    uint8_t free_one = kinematics_slots_free(&slots);
    PROVE(free_one <= NO_SLOT);
    PROVE(IMPLIES(free_one < NO_SLOT, !has(slots.valid | slots.damaged, free_one)));

    uint8_t counting = 0u;
    for (uint8_t i = 0u; i < KINEMATICS_STORE_SLOTS; i++) {
        bool counts = kinematics_slots_count(&slots, i);
        PROVE(IMPLIES(counts, has(slots.valid, i)));
        counting = (uint8_t)(counting + counts);
    }
    PROVE(IMPLIES(kinematics_slots_are_own(&slots), counting < KINEMATICS_STORE_SLOTS));
    return 0;
}
