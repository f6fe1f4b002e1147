/* A store of kinematics in a memory whose power can fail. */
#ifndef SUPPORT_STORE_RIG_H
#define SUPPORT_STORE_RIG_H

#include <stdbool.h>
#include <stdint.h>

#include "cycle/kinematics_store.h"

#define NEVER 1000000

extern uint8_t            store_rig_memory[KINEMATICS_STORE_BYTES];
extern kinematics_store_t store_rig_store;
extern uint32_t           store_rig_cut_at; /* the byte that power failed before */

/* An empty store, mounted; what stands in the memory, mounted, and what was left undone done. */
void store_rig_set_up(void);
void store_rig_mount(void);

/* Carry out what was begun; power fails after `bytes` bytes. True if all was written before. */
bool store_rig_write_until(int bytes);

/* Carry out all of what was begun without an error. */
void store_rig_finish(kinematics_store_error_t error);

kinematics_designation_t store_rig_number(uint32_t value);
kinematics_designation_t store_rig_name(const char *text);

/* Begin cycle 450. */
kinematics_store_error_t store_rig_start(kinematics_store_mode_t         mode,
                                         const kinematics_designation_t *designation);

/* Make a text the active description, respectively save the active one: all of it. */
void store_rig_activate(const char *payload);
void store_rig_save_as(kinematics_designation_t designation);

bool store_rig_active_is(const char *payload);
bool store_rig_saved_is(kinematics_designation_t designation, const char *payload);
bool store_rig_is_saved(kinematics_designation_t designation);
int  store_rig_count(void);

/* The bytes of a slot, its checksum set right, and a slot written by somebody else. */
uint8_t *store_rig_slot(uint8_t slot);
void     store_rig_close(uint8_t *slot);
void     store_rig_forge(uint8_t slot, uint32_t serial, const kinematics_designation_t *designation,
                         const char *payload);

#endif
