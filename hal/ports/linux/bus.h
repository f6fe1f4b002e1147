/*
 * The report bus: SocketCAN, one raw socket. hal_bus_send() queues, bus_flush() hands the queue to
 * the kernel; what the kernel cannot take now stays queued, in order.
 *
 * The socket hears three things only: its own frames as they leave (the kernel marks them), frames
 * of others under the same identifier (there should be none), and error frames.
 */
#ifndef LINUX_BUS_H
#define LINUX_BUS_H

#include <stdbool.h>
#include <stdint.h>

#define BUS_RETRY_MS 2 /* between two attempts to hand over what the kernel would not take */

typedef struct {
    uint64_t frames_sent;      /* taken by the kernel */
    uint64_t frames_confirmed; /* came back as sent; the rest never left, or is on its way */
    uint64_t frames_waiting;   /* queued now; at the end: never left */
    uint64_t frames_foreign;   /* of others under our identifier */
    uint64_t frames_missed;    /* received but thrown away: the receive queue was full */
    uint64_t queue_full;       /* times hal_bus_send() had to refuse */
    uint64_t send_full;        /* times the kernel's send queue was full */
    uint64_t downs;            /* times the interface was found down or gone */
    uint64_t bus_offs;         /* error frames by kind */
    uint64_t error_passives;
    uint64_t error_frames; /* all kinds */
    uint64_t slowest_us;   /* longest from handing over to the kernel's stamp of the sent frame */
} bus_counters_t;

/*
 * Open `interface` and send under identifier `id` (above 0x7FF: extended) from now on. 0, or an
 * errno after a line that says what to do.
 */
int bus_open(const char *interface, uint32_t id);

void bus_close(void);

/* To be polled for reading; negative while there is no socket. */
int bus_fd(void);

/* Hand the queue to the kernel as far as it takes it. True once nothing is queued. */
bool bus_flush(void);

/* Take in all that was received; call it after the poll. */
void bus_receive(void);

/* The interface is down or gone. */
bool bus_is_down(void);

/* After the interface went: bind to it again if it is back. */
void bus_recover(void);

bus_counters_t bus_counters(void);

#endif
