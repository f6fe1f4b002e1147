/*
 * Plays a train of pulses: says when the line is next to change and to which level. The port asks
 * when that time has come, drives the line, and tells when it did.
 */
#ifndef INJECT_TRAIN_H
#define INJECT_TRAIN_H

#include <stdbool.h>
#include <stdint.h>

#include "inject/inject_guard.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Start from all zeros: nothing plays. Times in microseconds, wrapping. */
typedef struct {
    inject_shot_t shot;
    uint32_t      lead_us;   /* when the pulse that comes next, or now plays, should begin */
    uint32_t      due_us;    /* when the line changes next */
    uint16_t      remaining; /* pulses that have not ended */
    bool          is_driven; /* within a pulse */
} inject_train_t;

/* Begin to play `shot`, whose trigger came at `now_us`. */
void inject_train_begin(inject_train_t *train, const inject_shot_t *shot, uint32_t now_us);

/* Whether the line still has to change. */
bool inject_train_is_playing(const inject_train_t *train);

/* How long until it has to, from `now_us` on; 0 if that time has come. Only while playing. */
uint32_t inject_train_wait_us(const inject_train_t *train, uint32_t now_us);

/* Whether the change that is due begins a pulse. Only while playing. */
bool inject_train_is_leading(const inject_train_t *train);

/* The level the line then takes. Only while playing. */
uint8_t inject_train_level(const inject_train_t *train);

/*
 * The line was driven at `driven_us`. A late pulse keeps its width, and the pulses after it keep
 * to the period if there is time.
 */
void inject_train_advance(inject_train_t *train, uint32_t driven_us);

#ifdef __cplusplus
}
#endif

#endif
