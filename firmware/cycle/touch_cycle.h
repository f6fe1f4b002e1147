/*
 * Probing cycles as a polled state machine: one touch, or a fast touch, back-off and a slow
 * measuring touch. The cycle asks for motions and the caller carries them out; it latches through
 * whichever input `latch` belongs to.
 *
 * One measurement: touch_cycle_start(), then poll, carry out requests and hand on latched records
 * until touch_cycle_poll() returns TOUCH_DONE or TOUCH_FAILED. Overtravel, what the axis goes on
 * after the latch (reaction, deceleration, whatever is left in a motion queue), is reported apart
 * from it.
 */
#ifndef CYCLE_TOUCH_CYCLE_H
#define CYCLE_TOUCH_CYCLE_H

#include <stdbool.h>
#include <stdint.h>

#include "input/latch.h"
#include "input/latch_record.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum {
    TOUCH_IDLE,
    TOUCH_APPROACHING, /* the fast, or the only, touch */
    TOUCH_STOPPING,    /* after it; re-triggers while decelerating belong to the touch */
    TOUCH_BACKING_OFF,
    TOUCH_MEASURING, /* the slow touch */
    TOUCH_MEASURED,  /* stopping after the slow touch */
    TOUCH_RETURNING, /* to the start */
    TOUCH_DONE,
    TOUCH_FAILED /* the axis stops where it is; touch_result_t says why */
} touch_state_t;

typedef enum {
    TOUCH_OK,
    TOUCH_ERR_CONFIG,             /* a value is out of its range; nothing moves */
    TOUCH_ERR_DEFLECTED_AT_START, /* already deflected; nothing moves */
    TOUCH_ERR_UNARMED_TOUCH,      /* touched since the last cycle, while not armed; nothing moves */
    TOUCH_ERR_NO_TOUCH,           /* no touch within the travel */
    TOUCH_ERR_DEFLECTED_IN_RETREAT, /* released, then touched again on the way back */
    TOUCH_ERR_STUCK_DEFLECTED,      /* not released within settle_us after the retreat */
    TOUCH_ERR_TIMEOUT               /* a motion took longer than timeout_us */
} touch_error_t;

/* Positions in counts of the axis, each below 2^28. */
typedef struct {
    bool     two_touches;
    int32_t  approach_counts;     /* stand-off, start to nominal surface; its sign is the sense */
    int32_t  overtravel_counts;   /* how far past the nominal surface to look for it, > 0 */
    int32_t  back_off_counts;     /* from the first latch back, > 0; two touches only */
    double   feed_mm_min;         /* of the first touch, the back-off and the return, > 0 */
    double   measure_feed_mm_min; /* of the second touch, > 0; two touches only */
    uint32_t timeout_us;          /* for each motion; 0 for none */
    uint32_t settle_us;           /* the release may come this long after the end of a retreat */
    uint32_t confirm_us;          /* debounce: see latch_config_t */
    uint32_t holdoff_us;          /* bounces, of contact and of release alike */
} touch_config_t;

typedef enum { TOUCH_MOVE, TOUCH_STOP } touch_request_kind_t;

/* A motion the caller has to begin at once. */
typedef struct {
    touch_request_kind_t kind;
    int32_t              target_counts; /* TOUCH_MOVE only */
    double               feed_mm_min;   /* TOUCH_MOVE only */
} touch_request_t;

/* What the cycle has to know at each poll. */
typedef struct {
    uint32_t now_ticks;
    int32_t  position_counts;
    bool     is_moving; /* true from the moment a TOUCH_MOVE is taken until standstill */
} touch_input_t;

typedef struct {
    touch_error_t  error;
    latch_record_t latch;             /* the measuring touch */
    int32_t        overtravel_counts; /* latch to standstill along the approach, measuring touch */
    int32_t        fast_overtravel_counts; /* the same for the first of two touches, else 0 */
    uint32_t       duration_ticks;         /* start to the end of the return; wraps */
} touch_result_t;

/* Owned by the caller; the fields are for this module. Start from all zeros. */
typedef struct {
    touch_config_t  config;
    touch_result_t  result;
    touch_request_t request;
    latch_config_t  latch_config;
    latch_t        *latch;
    touch_state_t   state;
    uint32_t        timeout_ticks;
    uint32_t        settle_ticks;
    uint32_t        start_ticks;
    uint32_t        since_ticks; /* of the present motion; once it is over, of the standstill */
    uint32_t        released_ticks;
    int32_t         start_counts;
    int32_t         sense; /* 1 or -1 */
    bool            has_request;
    bool            has_latch;   /* the measuring latch waits for touch_cycle_take_latch() */
    bool            has_lost;    /* a record was lost, and none that was taken has told so yet */
    bool            is_released; /* in this retreat */
    bool            has_bounced; /* the hold-off after that release is over */
    bool            is_at_rest;  /* the axis stands, and the cycle waits for the release */
} touch_cycle_t;

/* Whether touch_cycle_start() takes these values at that position. Any context but an ISR. */
bool touch_cycle_config_is_sound(const touch_config_t *config, int32_t start_counts);

/*
 * Begin a cycle on an input that is started and polled by the caller. Task. Returns TOUCH_OK, or
 * the error that also stands in the result; nothing moves then. Carry out the first request after
 * it. A record of the cycle before that nobody took is lost: counted as an overrun by the latch,
 * and flagged in the next one.
 */
touch_error_t touch_cycle_start(touch_cycle_t *cycle, latch_t *latch, const touch_config_t *config,
                                const touch_input_t *input);

/* One step, after the input itself was polled. Task. */
touch_state_t touch_cycle_poll(touch_cycle_t *cycle, const touch_input_t *input);

/* Take the motion to begin now. False if there is none. Task. */
bool touch_cycle_take_request(touch_cycle_t *cycle, touch_request_t *request);

/* Take the record of the measuring touch as soon as it is confirmed, once. Task. */
bool touch_cycle_take_latch(touch_cycle_t *cycle, latch_record_t *record);

/* Whole only once the state is TOUCH_DONE or TOUCH_FAILED. Task. */
const touch_result_t *touch_cycle_result(const touch_cycle_t *cycle);

/*
 * How long polling can be left out while input and axis stay as they are; TICKS_NEVER when not
 * running. Task.
 */
uint32_t touch_cycle_idle_ticks(const touch_cycle_t *cycle, uint32_t now_ticks);

#ifdef __cplusplus
}
#endif

#endif
