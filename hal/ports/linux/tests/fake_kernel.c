#include "fake_kernel.h"

#include <errno.h>
#include <fcntl.h>

#include "hal_bus.h"
#include "unity.h"

fake_kernel_t fake_kernel;

void fake_kernel_set_up(void)
{
    fake_kernel = (fake_kernel_t){.receive_error = EAGAIN, .up = 1};
}

int can_socket_open(const char *interface, uint32_t id)
{
    (void)interface;
    TEST_ASSERT_EQUAL_HEX32(FAKE_KERNEL_ID, id);
    if (fake_kernel.open_error != 0) {
        return -fake_kernel.open_error;
    }
    ++fake_kernel.opened;
    return open("/dev/null", O_RDONLY | O_CLOEXEC);
}

int can_socket_receive(int socket, can_received_t *received)
{
    TEST_ASSERT_GREATER_OR_EQUAL_INT(0, socket);
    if (fake_kernel.received_count == fake_kernel.to_receive_count) {
        int error = fake_kernel.receive_error;
        fake_kernel.receive_error = EAGAIN;
        return error;
    }
    *received = fake_kernel.to_receive[fake_kernel.received_count++];
    return 0;
}

int can_socket_send(int socket, const struct can_frame *frame)
{
    TEST_ASSERT_GREATER_OR_EQUAL_INT(0, socket);
    TEST_ASSERT_EQUAL_HEX32(FAKE_KERNEL_ID, frame->can_id);
    TEST_ASSERT_EQUAL_UINT8(HAL_BUS_FRAME_BYTES, frame->len);
    if (fake_kernel.send_error != 0) {
        return fake_kernel.send_error;
    }
    fake_kernel.sent[fake_kernel.sent_count++ % FAKE_KERNEL_SENT_MAX] = frame->data[0];
    return 0;
}

int can_socket_is_up(const char *interface)
{
    (void)interface;
    return fake_kernel.up;
}

uint32_t can_socket_id(uint32_t id)
{
    return id;
}

void can_socket_explain(const char *interface, int error)
{
    (void)interface;
    TEST_ASSERT_GREATER_THAN_INT(0, error);
}
