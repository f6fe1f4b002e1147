/* Values of which nothing is known, as CBMC gives them for functions of these names. */
#ifndef PROOFS_ANY_H
#define PROOFS_ANY_H

#include <stdbool.h>
#include <stdint.h>

bool     nondet_bool(void);
uint8_t  nondet_u8(void);
uint16_t nondet_u16(void);
uint32_t nondet_u32(void);
uint64_t nondet_u64(void);
int16_t  nondet_i16(void);
int32_t  nondet_i32(void);

#define ASSUME(condition) __CPROVER_assume(condition)
#define PROVE(condition)  __CPROVER_assert(condition, #condition)

/* a implies b. */
#define IMPLIES(a, b) (!(a) || (b))

#endif
