/* The report bus: frames of eight bytes to the recorder, over CAN or a UART. */
#ifndef HAL_BUS_H
#define HAL_BUS_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define HAL_BUS_FRAME_BYTES 8u

/*
 * Queue one frame for sending; the bytes are copied before the return. Frames leave in the order
 * in which they were queued. Task. Returns HAL_OK, or HAL_ERR_BUSY while the queue is full.
 */
int hal_bus_send(const uint8_t frame[HAL_BUS_FRAME_BYTES]);

#ifdef __cplusplus
}
#endif

#endif
