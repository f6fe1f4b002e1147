#include "bus.h"

#include <errno.h>
#include <linux/can/error.h>
#include <net/if.h>
#include <string.h>
#include <unistd.h>

#include "can_socket.h"
#include "clock.h"
#include "frame_queue.h"
#include "hal_bus.h"
#include "hal_error.h"
#include "say.h"

#define GIVEN_UP_NS CLOCK_NS_PER_S

/* One frame at a time is followed from here to the bus. */
typedef struct {
    bool     is_waiting;
    uint8_t  data[HAL_BUS_FRAME_BYTES];
    uint64_t sent_at_ns;
} awaited_t;

static char           name[IFNAMSIZ];
static uint32_t       identifier;
static int            can = -1;
static frame_queue_t  queue;
static awaited_t      awaited;
static bool           is_down;
static uint32_t       missed_before;
static bus_counters_t counted;

static void note_down(int error)
{
    if (!is_down) {
        ++counted.downs;
        say("CAN interface \"%s\" is %s: frames wait", name, error == ENETDOWN ? "down" : "gone");
    }
    is_down = true;
}

static void note_up(void)
{
    if (is_down) {
        say("CAN interface \"%s\" is up again", name);
    }
    is_down = false;
}

static bool is_up(void)
{
    return can_socket_is_up(name) == 1;
}

int bus_open(const char *interface, uint32_t id)
{
    bus_close();
    if (strlen(interface) >= sizeof name) {
        can_socket_explain(interface, ENODEV);
        return ENODEV;
    }
    strcpy(name, interface); /* NOLINT(clang-analyzer-security.insecureAPI.strcpy): it fits */
    identifier = id;
    can = can_socket_open(name, id);
    int error = can < 0 ? -can : 0;
    if (error == 0 && !is_up()) {
        error = ENETDOWN;
    }
    if (error != 0) {
        bus_close();
        can_socket_explain(interface, error);
    }
    return error;
}

static void close_socket(void)
{
    if (can >= 0) {
        (void)close(can);
    }
    can = -1;
    missed_before = 0u;
}

void bus_close(void)
{
    close_socket();
    queue.count = 0u;
    is_down = false;
    awaited.is_waiting = false;
    counted = (bus_counters_t){0};
}

int bus_fd(void)
{
    return can;
}

bool bus_is_down(void)
{
    return is_down;
}

/* A socket outlives "down", but not the interface itself. */
void bus_recover(void)
{
    if (can < 0) {
        int opened = can_socket_open(name, identifier);
        can = opened < 0 ? -1 : opened;
    }
    if (can >= 0 && is_up()) {
        note_up();
    }
}

static void note_fault(int error)
{
    switch (error) {
    case ENETDOWN:
        note_down(error);
        break;
    case ENODEV:
    case ENXIO:
        note_down(error);
        close_socket();
        break;
    case ENOBUFS:
    case EAGAIN:
    default:
        ++counted.send_full;
        break;
    }
}

/* A frame that has not come back for so long never will: the interface went down on it. */
static void await_frame(const uint8_t *data, uint64_t now_ns)
{
    if (!awaited.is_waiting || now_ns - awaited.sent_at_ns > GIVEN_UP_NS) {
        awaited.is_waiting = true;
        awaited.sent_at_ns = now_ns;
        memcpy(awaited.data, data, HAL_BUS_FRAME_BYTES);
    }
}

bool bus_flush(void)
{
    struct can_frame frame = {.can_id = can_socket_id(identifier), .len = HAL_BUS_FRAME_BYTES};
    const uint8_t   *first = NULL;
    while ((first = frame_queue_first(&queue)) != NULL && can >= 0 && !is_down) {
        memcpy(frame.data, first, HAL_BUS_FRAME_BYTES);
        uint64_t now_ns = clock_now_ns();
        int      error = can_socket_send(can, &frame);
        if (error != 0) {
            note_fault(error);
            return false;
        }
        ++counted.frames_sent;
        await_frame(first, now_ns);
        frame_queue_pop(&queue);
    }
    return first == NULL;
}

/* ---- receiving ---- */

static void count_own(const can_received_t *received)
{
    ++counted.frames_confirmed;
    if (!awaited.is_waiting ||
        memcmp(awaited.data, received->frame.data, HAL_BUS_FRAME_BYTES) != 0) {
        return;
    }
    awaited.is_waiting = false;
    if (received->at_ns > awaited.sent_at_ns) {
        uint64_t us = (received->at_ns - awaited.sent_at_ns) / CLOCK_NS_PER_US;
        counted.slowest_us = us > counted.slowest_us ? us : counted.slowest_us;
    }
}

static void count_error(const struct can_frame *frame)
{
    ++counted.error_frames;
    if ((frame->can_id & CAN_ERR_BUSOFF) != 0u) {
        ++counted.bus_offs;
        say("CAN interface \"%s\": bus-off; it restarts by itself if set up so, else: "
            "ip link set %s type can restart",
            name, name);
    }
    bool is_passive = (frame->can_id & CAN_ERR_CRTL) != 0u &&
                      (frame->data[1] & (CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE)) != 0u;
    counted.error_passives += is_passive ? 1u : 0u;
}

static void count_received(const can_received_t *received)
{
    if (received->has_missed) {
        counted.frames_missed += (uint32_t)(received->missed - missed_before);
        missed_before = received->missed;
    }
    if ((received->frame.can_id & CAN_ERR_FLAG) != 0u) {
        count_error(&received->frame);
    } else if (received->is_own) {
        count_own(received);
    } else {
        ++counted.frames_foreign;
    }
}

void bus_receive(void)
{
    can_received_t received;
    int            error = 0;
    while (can >= 0 && (error = can_socket_receive(can, &received)) == 0) {
        count_received(&received);
    }
    if (error != 0 && error != EAGAIN) {
        note_fault(error);
    }
}

bus_counters_t bus_counters(void)
{
    bus_counters_t now = counted;
    now.frames_waiting = queue.count;
    return now;
}

/* ---- hal_bus.h ---- */

int hal_bus_send(const uint8_t frame[HAL_BUS_FRAME_BYTES])
{
    if (!frame_queue_push(&queue, frame)) {
        ++counted.queue_full;
        return HAL_ERR_BUSY;
    }
    return HAL_OK;
}
