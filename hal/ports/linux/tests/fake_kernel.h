/* A kernel in place of hal/ports/linux/can_socket.c, which takes and gives frames as a test says.
 */
#ifndef FAKE_KERNEL_H
#define FAKE_KERNEL_H

#include <stdint.h>

#include "../hal/ports/linux/can_socket.h"

#define FAKE_KERNEL_ID           0x181u /* of the frames of the latch */
#define FAKE_KERNEL_SENT_MAX     1024u
#define FAKE_KERNEL_RECEIVED_MAX 16u

typedef struct {
    int            open_error; /* errors are errno, 0: none */
    int            send_error;
    int            receive_error; /* once what there is to receive is received; EAGAIN after that */
    int            up;
    unsigned       opened;
    uint8_t        sent[FAKE_KERNEL_SENT_MAX]; /* first byte of each */
    unsigned       sent_count;
    can_received_t to_receive[FAKE_KERNEL_RECEIVED_MAX];
    unsigned       received_count;
    unsigned       to_receive_count;
} fake_kernel_t;

extern fake_kernel_t fake_kernel;

/* An interface that is up, and nothing to receive. */
void fake_kernel_set_up(void);

#endif
