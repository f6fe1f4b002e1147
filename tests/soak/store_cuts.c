#include "store_cuts.h"

#include <string.h>

#define CUT_MAX 200u /* bytes: as many as an operation writes, on average */
#define WRITES  100u

typedef struct {
    uint32_t active;
    uint32_t saved[STORE_CUTS_NUMBERS];
} view_t;

static kinematics_designation_t numbered(uint32_t n)
{
    kinematics_designation_t designation;
    (void)kinematics_store_number(&designation, n);
    return designation;
}

static uint16_t describe(uint32_t number, uint8_t *payload)
{
    uint16_t length = (uint16_t)(sizeof number + number % (KINEMATICS_STORE_PAYLOAD_MAX - 3u));
    memset(payload, (int)(number & 0xFFu), length);
    memcpy(payload, &number, sizeof number);
    return length;
}

/* The number of a description; 0 for none, UINT32_MAX for a torn one. */
static uint32_t identify(bool is_found, const kinematics_record_t *record)
{
    uint8_t  payload[KINEMATICS_STORE_PAYLOAD_MAX];
    uint32_t number = 0u;
    if (!is_found) {
        return 0u;
    }
    memcpy(&number, record->payload, sizeof number);
    uint16_t length = describe(number, payload);
    bool     is_whole = record->length == length && memcmp(record->payload, payload, length) == 0;
    return is_whole ? number : UINT32_MAX;
}

static view_t look(const store_cuts_t *rig)
{
    kinematics_record_t record;
    view_t              view;
    view.active = identify(kinematics_store_active(&rig->store, &record), &record);
    for (uint32_t n = 0u; n < STORE_CUTS_NUMBERS; ++n) {
        kinematics_designation_t designation = numbered(n);
        view.saved[n] =
            identify(kinematics_store_find(&rig->store, &designation, &record), &record);
    }
    return view;
}

static bool is_same(const view_t *one, const view_t *other)
{
    return memcmp(one, other, sizeof *one) == 0;
}

/* Carry out what was begun, up to so many bytes; what the power then garbles is one page. */
static bool write_until(store_cuts_t *rig, uint32_t bytes)
{
    kinematics_store_write_t write;
    for (uint32_t i = 0u; i < WRITES && kinematics_store_next_write(&rig->store, &write); ++i) {
        if (bytes < write.length) {
            uint32_t at = write.offset + bytes;
            uint32_t page = at - at % KINEMATICS_STORE_PAGE_BYTES;
            memcpy(rig->memory + write.offset, write.bytes, bytes);
            for (uint32_t k = 0u; k < KINEMATICS_STORE_PAGE_BYTES; ++k) {
                rig->memory[page + k] = (uint8_t)dice_below(&rig->dice, 256u);
            }
            return false;
        }
        memcpy(rig->memory + write.offset, write.bytes, write.length);
        bytes -= write.length;
    }
    return true;
}

/* Begin any operation; give what shall be, which is what was where it is refused. */
static view_t begin(store_cuts_t *rig, const view_t *before)
{
    uint8_t                  payload[KINEMATICS_STORE_PAYLOAD_MAX];
    view_t                   wanted = *before;
    uint32_t                 n = dice_below(&rig->dice, STORE_CUTS_NUMBERS);
    kinematics_designation_t designation = numbered(n);
    uint32_t                 kind = dice_below(&rig->dice, 4u);
    bool                     is_missing = before->saved[n] == 0u;

    if (kind == 0u) {
        wanted.active = ++rig->made;
        (void)kinematics_store_activate(&rig->store, payload, describe(wanted.active, payload));
    } else if (kind == 1u) {
        wanted.saved[n] = wanted.active;
        (void)kinematics_store_start(&rig->store, KINEMATICS_STORE_SAVE, &designation);
    } else if (kind == 2u) {
        wanted.active = is_missing ? wanted.active : wanted.saved[n];
        (void)kinematics_store_start(&rig->store, KINEMATICS_STORE_RESTORE, &designation);
    } else {
        wanted.saved[n] = 0u;
        (void)kinematics_store_start(&rig->store, KINEMATICS_STORE_DELETE, &designation);
    }
    return wanted;
}

void store_cuts_start(store_cuts_t *rig, uint64_t seed)
{
    uint8_t payload[KINEMATICS_STORE_PAYLOAD_MAX];
    memset(rig, 0, sizeof *rig);
    rig->dice = dice_seed(seed);
    kinematics_store_mount(&rig->store, rig->memory);
    rig->made = 1u;
    (void)kinematics_store_activate(&rig->store, payload, describe(rig->made, payload));
    (void)write_until(rig, UINT32_MAX);
}

const char *store_cuts_play(store_cuts_t *rig)
{
    view_t before = look(rig);
    view_t wanted = begin(rig, &before);
    bool   is_whole = write_until(rig, dice_below(&rig->dice, CUT_MAX));

    kinematics_store_mount(&rig->store, rig->memory);
    while (!write_until(rig, dice_below(&rig->dice, CUT_MAX))) { /* and cuts while it settles */
        kinematics_store_mount(&rig->store, rig->memory);
        ++rig->cuts;
    }
    ++rig->operations;
    rig->cuts += !is_whole;
    if (kinematics_store_check(&rig->store) != KINEMATICS_STORE_OK) {
        return "the store is refused";
    }
    view_t after = look(rig);
    if (is_same(&after, &wanted) || (!is_whole && is_same(&after, &before))) {
        return NULL;
    }
    return is_whole ? "the store has not what was written" : "a cut has mixed up the store";
}
