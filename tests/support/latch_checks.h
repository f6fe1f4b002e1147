/* What tests of latching say again and again. */
#ifndef SUPPORT_LATCH_CHECKS_H
#define SUPPORT_LATCH_CHECKS_H

#include <stdint.h>

#include "input/latch.h"

/* Fail unless these are the counts. */
void latch_check_counters(const latch_t *latch, const latch_counters_t *expected);

/* Fail unless a record can be taken; return it. */
latch_record_t latch_check_take(latch_t *latch);

/* Fail if a record can be taken. */
void latch_check_nothing(latch_t *latch);

/* Fail unless exactly this record can be taken. */
void latch_check_record(latch_t *latch, uint32_t ticks, int32_t position_counts, uint8_t flags);

#endif
