#include "api/kinematics_memory.h"

#include <stdlib.h>
#include <string.h>

#include "cycle/kinematics_store.h"

_Static_assert(SIM_450_WRITE_MAX == KINEMATICS_STORE_WRITE_MAX, "the sizes are the store's");
_Static_assert(SIM_450_PAYLOAD_MAX == KINEMATICS_STORE_PAYLOAD_MAX, "the sizes are the store's");
_Static_assert(SIM_450_TEXT_MAX == KINEMATICS_STORE_NAME_MAX + 1, "the sizes are the store's");
_Static_assert(SIM_450_DAMAGED == (int)KINEMATICS_STORE_ERR_DAMAGED, "the errors are the store's");

struct sim_kinematics_memory {
    kinematics_store_t store;
    uint8_t            memory[KINEMATICS_STORE_BYTES];
};

uint32_t sim_kinematics_memory_bytes(void)
{
    return KINEMATICS_STORE_BYTES;
}

sim_kinematics_memory_t *sim_kinematics_memory_open(const uint8_t *memory)
{
    sim_kinematics_memory_t *play = calloc(1u, sizeof *play);
    if (play != NULL) {
        memcpy(play->memory, memory, sizeof play->memory);
        kinematics_store_mount(&play->store, play->memory);
    }
    return play;
}

void sim_kinematics_memory_close(sim_kinematics_memory_t *play)
{
    free(play);
}

int sim_kinematics_memory_check(const sim_kinematics_memory_t *play)
{
    return (int)kinematics_store_check(&play->store);
}

int sim_kinematics_memory_discard_damaged(sim_kinematics_memory_t *play)
{
    return (int)kinematics_store_discard_damaged(&play->store);
}

int sim_kinematics_memory_start(sim_kinematics_memory_t *play, double mode, double number,
                                const char *name)
{
    kinematics_designation_t designation;
    kinematics_store_error_t error = name == NULL ? kinematics_store_number(&designation, number)
                                                  : kinematics_store_name(&designation, name);
    if (error != KINEMATICS_STORE_OK) {
        return (int)error;
    }
    return (int)kinematics_store_start(&play->store, mode, &designation);
}

int sim_kinematics_memory_activate(sim_kinematics_memory_t *play, const uint8_t *payload,
                                   uint16_t length)
{
    return (int)kinematics_store_activate(&play->store, payload, length);
}

const char *sim_kinematics_memory_phrase(int error)
{
    return kinematics_store_phrase((kinematics_store_error_t)error);
}

uint32_t sim_kinematics_memory_next_write(sim_kinematics_memory_t *play, uint32_t *offset,
                                          uint8_t *bytes)
{
    kinematics_store_write_t write;
    if (!kinematics_store_next_write(&play->store, &write)) {
        return 0u;
    }
    memcpy(&play->memory[write.offset], write.bytes, write.length);
    memcpy(bytes, write.bytes, write.length);
    *offset = write.offset;
    return write.length;
}

uint32_t sim_kinematics_memory_active(const sim_kinematics_memory_t *play, uint8_t *payload)
{
    kinematics_record_t record;
    if (!kinematics_store_active(&play->store, &record)) {
        return 0u;
    }
    memcpy(payload, record.payload, record.length);
    return record.length;
}

int sim_kinematics_memory_show(const sim_kinematics_memory_t *play, uint8_t index, char *text)
{
    kinematics_record_t record;
    if (!kinematics_store_show(&play->store, index, &record)) {
        return 0;
    }
    kinematics_store_text(&record.designation, text);
    return 1;
}
