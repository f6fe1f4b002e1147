/*
 * The C codec of the injection protocol on the command line, to be compared with the DBC file. Each
 * line of input names a kind of frame and its fields; the frame is printed in hexadecimal.
 */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "inject/inject_frame.h"
#include "report/latch_frame.h"

#define FIELDS_MAX 8u

typedef uint8_t pair_t[2][INJECT_FRAME_BYTES];

static void print_frame(const uint8_t *frame)
{
    for (unsigned i = 0u; i < INJECT_FRAME_BYTES; ++i) {
        printf("%02x", frame[i]);
    }
    putchar('\n');
}

static void put_command(const uint64_t *field)
{
    uint8_t          frame[INJECT_FRAME_BYTES];
    inject_command_t command = {.kind = (uint8_t)field[0], .counter = (uint8_t)field[1]};
    command.page = (uint8_t)field[2];
    command.valid_ms = (uint16_t)field[2];
    command.line = (uint8_t)field[2];
    command.count = (uint16_t)field[2];
    command.token = (uint16_t)field[2];
    command.period_us = (uint32_t)field[3];
    command.delay_us = (uint32_t)field[3];
    command.width_us = (uint32_t)field[3];
    command.level = (uint8_t)field[4];
    inject_frame_put_command(&command, frame);
    print_frame(frame);
}

static void put_status(const uint64_t *field)
{
    uint8_t         frame[INJECT_FRAME_BYTES];
    inject_answer_t answer = {(uint8_t)field[2], (uint8_t)field[3], (uint8_t)field[4],
                              (uint16_t)field[5]};
    if (field[0] == 0u) {
        inject_frame_put_answer(&answer, (uint8_t)field[1], frame);
    } else {
        inject_frame_put_counts((uint8_t)field[0], (uint16_t)field[2], (uint16_t)field[3],
                                (uint8_t)field[1], frame);
    }
    print_frame(frame);
}

static void put_edge(const uint64_t *field)
{
    pair_t        frames;
    inject_edge_t edge = {.time_ns = field[0],
                          .number = (uint16_t)field[1],
                          .window_bits = (uint8_t)field[2],
                          .level = (uint8_t)field[3]};
    inject_frame_put_edge(&edge, (uint8_t)field[4], frames);
    print_frame(frames[0]);
    print_frame(frames[1]);
}

static void put_latch(const uint64_t *field)
{
    pair_t         frames;
    latch_record_t record = {.ticks = (uint32_t)field[0],
                             .position_counts = (int32_t)(uint32_t)field[1],
                             .sequence = (uint16_t)field[2],
                             .channel = (uint8_t)field[3],
                             .flags = (uint8_t)field[4]};
    latch_frame_encode(&record, frames);
    print_frame(frames[0]);
    print_frame(frames[1]);
}

static void read_fields(char *rest, uint64_t field[FIELDS_MAX])
{
    for (unsigned i = 0u; i < FIELDS_MAX; ++i) {
        field[i] = strtoull(rest, &rest, 0);
    }
}

int main(void)
{
    char line[256];
    while (fgets(line, sizeof line, stdin) != NULL) {
        uint64_t field[FIELDS_MAX];
        char    *space = strchr(line, ' ');
        if (space == NULL) {
            return EXIT_FAILURE;
        }
        *space = '\0';
        read_fields(space + 1, field);
        if (strcmp(line, "command") == 0) {
            put_command(field);
        } else if (strcmp(line, "status") == 0) {
            put_status(field);
        } else if (strcmp(line, "edge") == 0) {
            put_edge(field);
        } else {
            put_latch(field);
        }
        (void)fflush(stdout);
    }
    return EXIT_SUCCESS;
}
