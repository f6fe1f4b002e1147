#include "inject/inject_frame.h"

#include <string.h>

#include "inject/inject_crc.h"

#define COUNTER_OFFSET 6u
#define CRC_OFFSET     7u
#define SECOND_HALF    0x01u
#define LEVEL_SHIFT    1u
#define WINDOW_SHIFT   2u

static void put(uint8_t *bytes, uint64_t value, uint8_t count)
{
    for (uint8_t i = 0; i < count; ++i) {
        bytes[i] = (uint8_t)(value >> (8u * i));
    }
}

static uint16_t get_u16(const uint8_t *bytes)
{
    return (uint16_t)((uint32_t)bytes[0] | (uint32_t)bytes[1] << 8);
}

static uint32_t get_u24(const uint8_t *bytes)
{
    return (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16;
}

/* The sum up to the place of the CRC, begun with the id. */
static uint8_t sum(uint16_t id, const uint8_t *frame)
{
    uint8_t id_bytes[2];
    put(id_bytes, id, 2u);
    uint8_t crc = inject_crc_update(INJECT_CRC_START, id_bytes, 2u);
    return inject_crc_update(crc, frame, CRC_OFFSET);
}

static void close_frame(uint16_t id, uint8_t counter, uint8_t *frame)
{
    frame[COUNTER_OFFSET] = counter;
    frame[CRC_OFFSET] = inject_crc_finish(sum(id, frame));
}

void inject_frame_put_command(const inject_command_t *command, uint8_t frame[INJECT_FRAME_BYTES])
{
    memset(frame, 0, INJECT_FRAME_BYTES);
    frame[0] = command->kind;
    switch (command->kind) {
    case INJECT_ARM:
        put(&frame[1], command->valid_ms, 2u);
        break;
    case INJECT_PULSE:
        frame[1] = command->line;
        frame[2] = command->level;
        put(&frame[3], command->width_us, 3u);
        break;
    case INJECT_TRAIN:
        put(&frame[1], command->count, 2u);
        put(&frame[3], command->period_us, 3u);
        break;
    case INJECT_TRIGGER:
        put(&frame[1], command->token, 2u);
        put(&frame[3], command->delay_us, 3u);
        break;
    case INJECT_ASK:
        frame[1] = command->page;
        break;
    case INJECT_SEAL:
        memcpy(&frame[1], command->seal, INJECT_SEAL_BYTES);
        break;
    default: /* DISARM carries nothing */
        break;
    }
    close_frame(INJECT_ID_COMMAND, command->counter, frame);
}

static inject_command_t read_command(const uint8_t *frame)
{
    inject_command_t command = {.kind = frame[0], .counter = frame[COUNTER_OFFSET]};
    switch (command.kind) {
    case INJECT_ARM:
        command.valid_ms = get_u16(&frame[1]);
        break;
    case INJECT_PULSE:
        command.line = frame[1];
        command.level = frame[2];
        command.width_us = get_u24(&frame[3]);
        break;
    case INJECT_TRAIN:
        command.count = get_u16(&frame[1]);
        command.period_us = get_u24(&frame[3]);
        break;
    case INJECT_TRIGGER:
        command.token = get_u16(&frame[1]);
        command.delay_us = get_u24(&frame[3]);
        break;
    case INJECT_ASK:
        command.page = frame[1];
        break;
    case INJECT_SEAL:
        memcpy(command.seal, &frame[1], INJECT_SEAL_BYTES);
        break;
    default:
        break;
    }
    return command;
}

bool inject_frame_get_command(const uint8_t frame[INJECT_FRAME_BYTES], inject_command_t *command)
{
    if (inject_crc_finish(sum(INJECT_ID_COMMAND, frame)) != frame[CRC_OFFSET]) {
        return false;
    }
    *command = read_command(frame);
    return true;
}

void inject_frame_put_answer(const inject_answer_t *answer, uint8_t counter,
                             uint8_t frame[INJECT_FRAME_BYTES])
{
    frame[0] = 0u;
    frame[1] = answer->state;
    frame[2] = answer->verdict;
    frame[3] = answer->answered;
    put(&frame[4], answer->token, 2u);
    close_frame(INJECT_ID_STATUS, counter, frame);
}

void inject_frame_put_counts(uint8_t page, uint16_t first, uint16_t second, uint8_t counter,
                             uint8_t frame[INJECT_FRAME_BYTES])
{
    frame[0] = page;
    put(&frame[1], first, 2u);
    put(&frame[3], second, 2u);
    frame[5] = 0u;
    close_frame(INJECT_ID_STATUS, counter, frame);
}

void inject_frame_put_challenge(const uint8_t challenge[INJECT_SEAL_BYTES], uint8_t counter,
                                uint8_t frame[INJECT_FRAME_BYTES])
{
    frame[0] = INJECT_PAGE_CHALLENGE;
    memcpy(&frame[1], challenge, INJECT_SEAL_BYTES);
    close_frame(INJECT_ID_STATUS, counter, frame);
}

void inject_frame_put_edge(const inject_edge_t *edge, uint8_t counter,
                           uint8_t frames[INJECT_FRAMES_PER_EDGE][INJECT_FRAME_BYTES])
{
    uint8_t head =
        (uint8_t)((uint32_t)edge->window_bits << WINDOW_SHIFT | (edge->level & 1u) << LEVEL_SHIFT);
    frames[0][0] = head;
    put(&frames[0][1], edge->number, 2u);
    put(&frames[0][3], edge->time_ns, 3u);
    close_frame(INJECT_ID_EDGE, counter, frames[0]);

    frames[1][0] = (uint8_t)(head | SECOND_HALF);
    put(&frames[1][1], edge->time_ns >> 24, 5u);
    frames[1][COUNTER_OFFSET] = (uint8_t)(counter + 1u);
    uint8_t crc = inject_crc_update(sum(INJECT_ID_EDGE, frames[0]), frames[1], CRC_OFFSET);
    frames[1][CRC_OFFSET] = inject_crc_finish(crc);
}
