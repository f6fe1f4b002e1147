/* Latch records to try a codec on, and their comparison field by field. */
#ifndef SUPPORT_RECORDS_H
#define SUPPORT_RECORDS_H

#include <stdint.h>

#include "input/latch_record.h"

/* The n-th of an endless row of records that differ in all their bits; the same on every run. */
latch_record_t record_number(uint32_t n);

/* The same with a sequence number of choice. */
latch_record_t record_in_sequence(uint16_t sequence);

void records_check_equal(const latch_record_t *expected, const latch_record_t *actual);

#endif
