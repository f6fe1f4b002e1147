/*
 * Times round trips over a CAN interface: sends a frame, waits for the answer of another process.
 *
 *   can_round_trip INTERFACE ANSWER_ID GAP_US <requests >times_ns
 *
 * Requests are lines ID#DATA in hexadecimal, sent one after the other; the answer is the next frame
 * with ANSWER_ID, or, if that is 0, the next line of the third descriptor: what candump prints. One
 * line a round trip is printed, in ns; -1 if no answer came within a second.
 */
#include <errno.h>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <poll.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#define ANSWERS_FD  3
#define PATIENCE_MS 1000
#define NS_PER_S    INT64_C(1000000000)

static int64_t now_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * NS_PER_S + now.tv_nsec;
}

static int open_can(const char *interface, canid_t answer_id)
{
    int                 can = socket(PF_CAN, SOCK_RAW, CAN_RAW);
    struct can_filter   filter = {.can_id = answer_id, .can_mask = CAN_SFF_MASK};
    struct sockaddr_can address = {.can_family = AF_CAN,
                                   .can_ifindex = (int)if_nametoindex(interface)};
    if (can < 0 || address.can_ifindex == 0 ||
        setsockopt(can, SOL_CAN_RAW, CAN_RAW_FILTER, &filter,
                   answer_id != 0u ? sizeof filter : 0u) != 0 ||
        bind(can, (struct sockaddr *)&address, sizeof address) != 0) {
        fprintf(stderr, "can_round_trip: %s: %s\n", interface, strerror(errno));
        exit(2);
    }
    return can;
}

static bool read_request(struct can_frame *frame)
{
    unsigned id;
    char     digits[2 * CAN_MAX_DLEN + 1] = "";
    if (scanf("%x#%16s", &id, digits) != 2) {
        return false;
    }
    frame->can_id = id;
    frame->can_dlc = (uint8_t)(strlen(digits) / 2u);
    for (size_t i = 0; i < frame->can_dlc; ++i) {
        const char pair[] = {digits[2u * i], digits[2u * i + 1u], '\0'};
        frame->data[i] = (uint8_t)strtoul(pair, NULL, 16);
    }
    return true;
}

/* What comes in one piece is one answer; the next request is sent only after it. */
static bool await_answer(int from)
{
    struct pollfd wait = {.fd = from, .events = POLLIN};
    char          piece[4096];
    return poll(&wait, 1, PATIENCE_MS) == 1 && read(from, piece, sizeof piece) > 0;
}

int main(int argc, char **argv)
{
    if (argc != 4) {
        fprintf(stderr, "usage: can_round_trip INTERFACE ANSWER_ID GAP_US <requests\n");
        return 2;
    }
    canid_t answer_id = (canid_t)strtoul(argv[2], NULL, 16);
    int64_t gap_ns = 1000 * strtoll(argv[3], NULL, 10);
    int     can = open_can(argv[1], answer_id);
    int     answers = answer_id != 0u ? can : ANSWERS_FD;

    struct can_frame request = {0};
    while (read_request(&request)) {
        struct timespec gap = {.tv_nsec = gap_ns};
        nanosleep(&gap, NULL);
        int64_t start_ns = now_ns();
        if (write(can, &request, sizeof request) != sizeof request) {
            fprintf(stderr, "can_round_trip: %s: %s\n", argv[1], strerror(errno));
            return 2;
        }
        bool answered = await_answer(answers);
        printf("%lld\n", answered ? (long long)(now_ns() - start_ns) : -1LL);
    }
    return 0;
}
