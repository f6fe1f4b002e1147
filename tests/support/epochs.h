/* Instants at which a test of a wrapping clock is worth while: inside, around half and around the
 * wrap. */
#ifndef SUPPORT_EPOCHS_H
#define SUPPORT_EPOCHS_H

#include <stdint.h>

static const uint32_t EPOCHS[] = {
    0u,          1u,          1000u,       0x7FFFFFF0u, 0x7FFFFFFFu,
    0x80000000u, 0xFFFFFF00u, 0xFFFFFFF6u, 0xFFFFFFFEu, 0xFFFFFFFFu,
};

/* The body that follows runs once for each of them. */
#define FOR_EACH_EPOCH(epoch)                                                           \
    for (const uint32_t *at_ = EPOCHS, *end_ = EPOCHS + sizeof EPOCHS / sizeof *EPOCHS; \
         at_ != end_; ++at_)                                                            \
        for (uint32_t epoch = *at_, once_ = 1u; once_ != 0u; once_ = 0u)

#endif
