/*
 * The firmware's store of kinematics (cycle 450) for users of the shared library, who keep its
 * memory: they carry out each write, in its order, before they ask for the next. Python reads this
 * header too: no more of the preprocessor than what can be left out.
 */
#ifndef API_KINEMATICS_MEMORY_H
#define API_KINEMATICS_MEMORY_H

#include <stdint.h>

#pragma GCC visibility push(default)

enum {
    SIM_450_WRITE_MAX = 32,
    SIM_450_PAYLOAD_MAX = 272,
    SIM_450_TEXT_MAX = 17,
    SIM_450_DAMAGED = 8 /* of sim_kinematics_memory_check() */
};

typedef struct sim_kinematics_memory sim_kinematics_memory_t;

/* Size of the memory. */
uint32_t sim_kinematics_memory_bytes(void);

/*
 * Mount a copy of sim_kinematics_memory_bytes() of memory; NULL without memory for that. What a
 * power cut left undone are the next writes.
 */
sim_kinematics_memory_t *sim_kinematics_memory_open(const uint8_t *memory);
void                     sim_kinematics_memory_close(sim_kinematics_memory_t *play);

/*
 * Whether the memory can be used: kinematics_store_error_t. sim_kinematics_memory_discard_damaged()
 * goes on with what is left of one that has lost bits; then there are writes to carry out.
 */
int sim_kinematics_memory_check(const sim_kinematics_memory_t *play);
int sim_kinematics_memory_discard_damaged(sim_kinematics_memory_t *play);

/*
 * Begin cycle 450 with Q410 and Q409 = number, or with a `name` that is not NULL QS409. Returns
 * kinematics_store_error_t; sim_kinematics_memory_phrase() says it in words.
 */
int         sim_kinematics_memory_start(sim_kinematics_memory_t *play, double mode, double number,
                                        const char *name);
int         sim_kinematics_memory_activate(sim_kinematics_memory_t *play, const uint8_t *payload,
                                           uint16_t length);
const char *sim_kinematics_memory_phrase(int error);

/* The next write: up to SIM_450_WRITE_MAX `bytes` at `offset`. Returns how many, 0 at the end. */
uint32_t sim_kinematics_memory_next_write(sim_kinematics_memory_t *play, uint32_t *offset,
                                          uint8_t *bytes);

/* The active description, up to SIM_450_PAYLOAD_MAX bytes. Returns how many, 0 for none. */
uint32_t sim_kinematics_memory_active(const sim_kinematics_memory_t *play, uint8_t *payload);

/* Designation of saved record `index` as text, SIM_450_TEXT_MAX bytes. 0 past the last. */
int sim_kinematics_memory_show(const sim_kinematics_memory_t *play, uint8_t index, char *text);

#pragma GCC visibility pop

#endif
