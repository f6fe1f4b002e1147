/* A raw CAN socket with everything switched on that the port wants to know of the bus. */
#ifndef LINUX_CAN_SOCKET_H
#define LINUX_CAN_SOCKET_H

#include <linux/can.h>
#include <stdbool.h>
#include <stdint.h>

typedef struct {
    struct can_frame frame;
    uint64_t         at_ns;      /* CLOCK_MONOTONIC, by the kernel's stamp; 0 if it gave none */
    bool             is_own;     /* sent through this very socket */
    bool             has_missed; /* `missed` was told */
    uint32_t         missed;     /* frames thrown away for this socket since it was opened; wraps */
} can_received_t;

/*
 * Open `interface`, hearing only identifier `id`, own frames included, and error frames. Returns
 * the socket, or a negative errno.
 */
int can_socket_open(const char *interface, uint32_t id);

/* Take one frame without waiting. 0, or an errno; EAGAIN when there is none. */
int can_socket_receive(int socket, can_received_t *received);

/* Hand over one frame without waiting. 0, or an errno. */
int can_socket_send(int socket, const struct can_frame *frame);

/* Whether the interface is up: 1, 0, or a negative errno. */
int can_socket_is_up(const char *interface);

/* `id` as the kernel wants it: with a flag if it is an extended one. */
uint32_t can_socket_id(uint32_t id);

/* Say in one line why the interface cannot be had, and what to do. */
void can_socket_explain(const char *interface, int error);

#endif
