/*
 * Cycle 450, SAVE KINEMATICS: saves the active kinematics, restores, shows and deletes what was
 * saved, by number or by name. The active description itself stands in the store too, so that
 * restoring it, and applying what cycle 451 found, are as safe as saving.
 *
 * Whatever happens is a series of writes that the caller carries out one after the other, each
 * whole before the next. Mounting brings writes as well as each operation does, so the order is:
 * kinematics_store_mount(), kinematics_store_next_write() until there is none, and then time and
 * again kinematics_store_start() or another operation, and kinematics_store_next_write() until
 * there is none. A power cut before, in the middle of or
 * after any of them, which may garble the pages that it falls into, leaves the store as it was or
 * as it shall be, as kinematics_store_mount() finds it.
 *
 * A memory that has lost bits is told from a power cut: then there is no answer at all, and nothing
 * is written, until kinematics_store_discard_damaged() has accepted the loss. A flipped bit
 * therefore never brings back what a newer description has replaced.
 *
 * How. The memory is cut into slots of whole pages. A record is written into a free slot, then
 * becomes valid by a mark on a page of its own, and then the one that it replaces is wiped by
 * another mark. Of two valid ones with the same designation, after a power cut, the newer one
 * counts. One slot is always free.
 *
 * Task only; nothing here may be interrupted by itself.
 */
#ifndef CYCLE_KINEMATICS_STORE_H
#define CYCLE_KINEMATICS_STORE_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A check of every case at once takes a smaller store. */
#ifndef KINEMATICS_STORE_RECORDS
#define KINEMATICS_STORE_RECORDS     16  /* besides the active description; up to 30 */
#define KINEMATICS_STORE_PAYLOAD_MAX 272 /* bytes of a description */
#define KINEMATICS_STORE_PAGE_BYTES  64  /* of the memory, or a multiple of its pages */
#define KINEMATICS_STORE_NAME_MAX    16
#endif
#define KINEMATICS_STORE_NUMBER_MAX 99999
#define KINEMATICS_STORE_RECORD_PAGES                                                              \
    ((9 + KINEMATICS_STORE_NAME_MAX + KINEMATICS_STORE_PAYLOAD_MAX + KINEMATICS_STORE_PAGE_BYTES - \
      1) /                                                                                         \
     KINEMATICS_STORE_PAGE_BYTES)
#define KINEMATICS_STORE_SLOT_BYTES \
    ((1 + KINEMATICS_STORE_RECORD_PAGES) * KINEMATICS_STORE_PAGE_BYTES)
#define KINEMATICS_STORE_SLOTS     (KINEMATICS_STORE_RECORDS + 2)
#define KINEMATICS_STORE_BYTES     (KINEMATICS_STORE_SLOTS * KINEMATICS_STORE_SLOT_BYTES)
#define KINEMATICS_STORE_WRITE_MAX 32 /* bytes of one write */

/* Q410. */
typedef enum {
    KINEMATICS_STORE_SAVE,
    KINEMATICS_STORE_RESTORE,
    KINEMATICS_STORE_SHOW,
    KINEMATICS_STORE_DELETE
} kinematics_store_mode_t;

typedef enum {
    KINEMATICS_STORE_OK,
    KINEMATICS_STORE_ERR_MODE,        /* Q410 is not 0, 1, 2 or 3 */
    KINEMATICS_STORE_ERR_DESIGNATION, /* Q409 is no number from 0 to 99999, and no name */
    KINEMATICS_STORE_ERR_NOT_FOUND,
    KINEMATICS_STORE_ERR_FULL,
    KINEMATICS_STORE_ERR_NO_ACTIVE, /* there is no active description to save */
    KINEMATICS_STORE_ERR_LENGTH,    /* of a description: 0, or above the maximum */
    KINEMATICS_STORE_ERR_BUSY,      /* writes of the operation before, or of mounting, are left */
    KINEMATICS_STORE_ERR_DAMAGED,   /* the memory has lost bits */
    KINEMATICS_STORE_ERR_FOREIGN    /* what stands in the memory is not from this store */
} kinematics_store_error_t;

/* What records are found by; from kinematics_store_number() or _name(). */
typedef struct {
    uint8_t bytes[1 + KINEMATICS_STORE_NAME_MAX];
} kinematics_designation_t;

/* Bytes to put into the memory, before the next write is asked for. */
typedef struct {
    uint32_t offset;
    uint32_t length; /* up to KINEMATICS_STORE_WRITE_MAX */
    uint8_t  bytes[KINEMATICS_STORE_WRITE_MAX];
} kinematics_store_write_t;

typedef struct {
    kinematics_designation_t designation;
    const uint8_t           *payload; /* in the memory: until the next write */
    uint16_t                 length;
} kinematics_record_t;

/* Owned by the caller; the fields are for this module. */
typedef struct {
    const uint8_t *memory;
    uint8_t        image[KINEMATICS_STORE_SLOT_BYTES]; /* of the slot to be filled */
    uint16_t       image_length;
    uint16_t       written;
    uint8_t        slot;     /* to be filled */
    uint8_t        replaced; /* to be wiped after that */
    uint8_t        turn;     /* of settling what a power cut left */
    uint8_t        step;
} kinematics_store_t;

/*
 * Use KINEMATICS_STORE_BYTES of memory that can be read in place, from the beginning of a page;
 * all 0x00 and all 0xFF are empty stores. What a power cut left undone is then done by the next
 * writes, before any operation; so are the marks of a memory that is new, one a slot. Until then an
 * operation is KINEMATICS_STORE_ERR_BUSY.
 */
void kinematics_store_mount(kinematics_store_t *store, const uint8_t *memory);

/*
 * KINEMATICS_STORE_OK, ERR_DAMAGED or ERR_FOREIGN. Where it is not OK, nothing is found and nothing
 * is begun.
 */
kinematics_store_error_t kinematics_store_check(const kinematics_store_t *store);

/*
 * Go on with what is left in a memory that has lost bits, perhaps with what an operation before had
 * replaced: somebody has to have a look at it.
 */
kinematics_store_error_t kinematics_store_discard_damaged(kinematics_store_t *store);

/* Designate by Q409 = number, respectively by QS409 = name: 1 to 16 printable ASCII characters,
 * spaces within. */
kinematics_store_error_t kinematics_store_number(kinematics_designation_t *designation,
                                                 double                    number);
kinematics_store_error_t kinematics_store_name(kinematics_designation_t *designation,
                                               const char               *name);

/*
 * Cycle 450 with Q410 = `mode`; to show changes nothing, see kinematics_store_show(). With an error
 * there is nothing to write.
 */
kinematics_store_error_t kinematics_store_start(kinematics_store_t *store, double mode,
                                                const kinematics_designation_t *designation);

/* Make a description the active one: at delivery, and when cycle 451 applies what it found. */
kinematics_store_error_t kinematics_store_activate(kinematics_store_t *store,
                                                   const uint8_t *payload, uint16_t length);

/* The next write of the operation that was started; false once it is over. */
bool kinematics_store_next_write(kinematics_store_t *store, kinematics_store_write_t *write);

/* The active description; false if there is none. */
bool kinematics_store_active(const kinematics_store_t *store, kinematics_record_t *record);

/* The saved record of this designation; false if there is none. */
bool kinematics_store_find(const kinematics_store_t       *store,
                           const kinematics_designation_t *designation,
                           kinematics_record_t            *record);

/* Saved record `index`, 0 and on, in no order; false past the last. */
bool kinematics_store_show(const kinematics_store_t *store, uint8_t index,
                           kinematics_record_t *record);

/* A designation as text, a number or a name; KINEMATICS_STORE_NAME_MAX + 1 characters. */
void kinematics_store_text(const kinematics_designation_t *designation, char *text);

/* A phrase that names the parameter, where one is at fault. Any context. */
const char *kinematics_store_phrase(kinematics_store_error_t error);

#ifdef __cplusplus
}
#endif

#endif
