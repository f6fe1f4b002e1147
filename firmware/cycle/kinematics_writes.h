/*
 * The writes that an operation of the store of kinematics comes to, one after the other, and those
 * that do what a power cut left undone. kinematics_store_next_write() is here. Only
 * kinematics_store.c uses it. Task.
 */
#ifndef CYCLE_KINEMATICS_WRITES_H
#define CYCLE_KINEMATICS_WRITES_H

#include "cycle/kinematics_slots.h"
#include "cycle/kinematics_store.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What the next write is of; in kinematics_store_t. */
enum { STEP_IDLE, STEP_SETTLE, STEP_BODY, STEP_MARK, STEP_WIPE, STEP_DELETE };

/* All turns of settling are over. */
#define SETTLED (2 * KINEMATICS_STORE_SLOTS)

/* Put a description into a free slot, and then wipe the slot that it replaces. */
kinematics_store_error_t kinematics_writes_plan(kinematics_store_t             *store,
                                                const kinematics_slots_t       *slots,
                                                const kinematics_designation_t *designation,
                                                const uint8_t *payload, uint16_t length);

/* Do what a power cut left undone, if there is anything. */
void kinematics_writes_settle(kinematics_store_t *store, const kinematics_slots_t *slots);

#ifdef __cplusplus
}
#endif

#endif
