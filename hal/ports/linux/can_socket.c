#include "can_socket.h"

#include <errno.h>
#include <linux/can/raw.h>
#include <linux/net_tstamp.h>
#include <net/if.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <time.h>
#include <unistd.h>

#include "clock.h"
#include "say.h"

#define CONTROL_BYTES 256u
#define RECEIVE_BYTES (1 << 20)

uint32_t can_socket_id(uint32_t id)
{
    return id > CAN_SFF_MASK ? id | CAN_EFF_FLAG : id;
}

/*
 * Stamps of the interface's software: those of its hardware run on a clock of their own. A kernel
 * too old for SO_TIMESTAMPING still has SO_TIMESTAMPNS, which is the same stamp.
 */
static int switch_stamps_on(int socket)
{
    const int flags = SOF_TIMESTAMPING_RX_SOFTWARE | SOF_TIMESTAMPING_SOFTWARE;
    const int on = 1;
    if (setsockopt(socket, SOL_SOCKET, SO_TIMESTAMPING, &flags, sizeof flags) == 0) {
        return 0;
    }
    return setsockopt(socket, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on);
}

/* Room for the echo of a whole queue sent at once; less is no fault, as missed frames are told. */
static void widen(int socket)
{
    const int bytes = RECEIVE_BYTES;
    (void)setsockopt(socket, SOL_SOCKET, SO_RCVBUF, &bytes, sizeof bytes);
}

static int configure(int socket, uint32_t id)
{
    const struct can_filter filter = {
        .can_id = can_socket_id(id),
        .can_mask = CAN_EFF_FLAG | CAN_RTR_FLAG | (id > CAN_SFF_MASK ? CAN_EFF_MASK : CAN_SFF_MASK),
    };
    const can_err_mask_t errors = CAN_ERR_MASK;
    const int            on = 1;
    widen(socket);
    bool is_done =
        setsockopt(socket, SOL_CAN_RAW, CAN_RAW_FILTER, &filter, sizeof filter) == 0 &&
        setsockopt(socket, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &errors, sizeof errors) == 0 &&
        setsockopt(socket, SOL_CAN_RAW, CAN_RAW_LOOPBACK, &on, sizeof on) == 0 &&
        setsockopt(socket, SOL_CAN_RAW, CAN_RAW_RECV_OWN_MSGS, &on, sizeof on) == 0 &&
        setsockopt(socket, SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof on) == 0 &&
        switch_stamps_on(socket) == 0;
    return is_done ? 0 : -1;
}

static int bind_to(int socket, const char *interface)
{
    struct sockaddr_can address = {.can_family = AF_CAN};
    address.can_ifindex = (int)if_nametoindex(interface);
    if (address.can_ifindex == 0) {
        errno = ENODEV;
        return -1;
    }
    return bind(socket, (const struct sockaddr *)&address, sizeof address);
}

int can_socket_open(const char *interface, uint32_t id)
{
    int opened = socket(AF_CAN, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK, CAN_RAW);
    if (opened < 0) {
        return -errno;
    }
    if (configure(opened, id) != 0 || bind_to(opened, interface) != 0) {
        int error = errno;
        (void)close(opened);
        return -error;
    }
    return opened;
}

/* Both options deliver the software's stamp as the first timespec of the message. */
static uint64_t stamp_of(const struct cmsghdr *control)
{
    struct timespec realtime;
    memcpy(&realtime, CMSG_DATA(control), sizeof realtime);
    uint64_t ns = (uint64_t)realtime.tv_sec * CLOCK_NS_PER_S + (uint64_t)realtime.tv_nsec;
    return ns == 0u ? 0u : clock_monotonic_of_realtime_ns(ns);
}

static void read_control(struct msghdr *message, can_received_t *received)
{
    for (struct cmsghdr *control = CMSG_FIRSTHDR(message); control != NULL;
         control = CMSG_NXTHDR(message, control)) {
        if (control->cmsg_level != SOL_SOCKET) {
            continue;
        }
        if (control->cmsg_type == SCM_TIMESTAMPING || control->cmsg_type == SCM_TIMESTAMPNS) {
            received->at_ns = stamp_of(control);
        } else if (control->cmsg_type == SO_RXQ_OVFL) {
            memcpy(&received->missed, CMSG_DATA(control), sizeof received->missed);
            received->has_missed = true;
        }
    }
}

int can_socket_receive(int socket, can_received_t *received)
{
    _Alignas(struct cmsghdr) char bytes[CONTROL_BYTES];
    *received = (can_received_t){0};
    struct iovec  part = {.iov_base = &received->frame, .iov_len = sizeof received->frame};
    struct msghdr message = {
        .msg_iov = &part,
        .msg_iovlen = 1u,
        .msg_control = bytes,
        .msg_controllen = sizeof bytes,
    };
    ssize_t length = recvmsg(socket, &message, MSG_DONTWAIT);
    if (length != (ssize_t)sizeof received->frame) {
        return length < 0 ? errno : EBADMSG;
    }
    received->is_own = (message.msg_flags & MSG_CONFIRM) != 0;
    read_control(&message, received);
    return 0;
}

int can_socket_send(int socket, const struct can_frame *frame)
{
    ssize_t length = write(socket, frame, sizeof *frame);
    return length == (ssize_t)sizeof *frame ? 0 : errno;
}

int can_socket_is_up(const char *interface)
{
    struct ifreq query = {0};
    int          any = socket(AF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW);
    if (any < 0) {
        return -errno;
    }
    strncpy(query.ifr_name, interface, IFNAMSIZ - 1);
    int result = ioctl(any, SIOCGIFFLAGS, &query) == 0 ? (query.ifr_flags & IFF_UP) != 0 : -errno;
    (void)close(any);
    return result;
}

static void explain_missing(const char *interface)
{
    if (if_nametoindex(interface) != 0u) {
        say("\"%s\" is no CAN interface; see: ip -br link show type can", interface);
    } else if (strlen(interface) >= IFNAMSIZ) {
        say("no CAN interface \"%s\": a name has %d letters at most", interface, IFNAMSIZ - 1);
    } else {
        say("no CAN interface \"%s\"; see: ip -br link show type can; for a virtual one: "
            "ip link add %s type vcan && ip link set %s up",
            interface, interface, interface);
    }
}

void can_socket_explain(const char *interface, int error)
{
    switch (error) {
    case ENODEV:
        explain_missing(interface);
        break;
    case ENETDOWN:
        say("CAN interface \"%s\" is down; ip link set %s up (real hardware: with type can bitrate "
            "500000 in front of up)",
            interface, interface);
        break;
    case EAFNOSUPPORT:
    case EPROTONOSUPPORT:
        say("this kernel has no SocketCAN; modprobe can-raw");
        break;
    case EPERM:
    case EACCES:
        say("no permission for CAN sockets; run as root, or: sudo setcap cap_net_raw+ep PROGRAM");
        break;
    default:
        say("CAN interface \"%s\": %s", interface, strerror(error));
        break;
    }
}
