/*
 * The C codecs on the command line, to be compared with those of Python. Each line of input names a
 * kind of frame and its fields, and the frame is printed in hexadecimal; or it says what to make of
 * bytes that it gives in hexadecimal.
 */
#include <inttypes.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "inject/inject_crc.h"
#include "inject/inject_frame.h"
#include "inject/inject_guard.h"
#include "inject/inject_siphash.h"
#include "report/latch_crc.h"
#include "report/latch_frame.h"

#define FIELDS_MAX 8u
#define FRAMES_MAX 64u /* of one line */

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
    for (unsigned i = 0u; i < INJECT_SEAL_BYTES; ++i) {
        command.seal[i] = (uint8_t)(field[2] >> (8u * i));
    }
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

/* ---- what the decoders make of frames ---- */

static size_t read_bytes(const char *hex, uint8_t *bytes, size_t most)
{
    size_t   count = 0u;
    unsigned value;
    while (count < most && sscanf(hex + 2u * count, "%2x", &value) == 1) {
        bytes[count++] = (uint8_t)value;
    }
    return count;
}

static void take(latch_decoder_t *decoder, const uint8_t *frame)
{
    latch_record_t       record = {0};
    latch_frame_result_t result = latch_frame_decode(decoder, frame, &record);
    if (result == LATCH_FRAME_RECORD) {
        printf("%u:%u:%d:%u ", record.sequence, record.ticks, record.position_counts, record.flags);
    }
}

static void print_counters(const latch_decoder_t *decoder)
{
    printf("lost=%u damaged=%u repeated=%u unpaired=%u restarts=%u\n", decoder->lost_records,
           decoder->damaged_frames, decoder->repeated_frames, decoder->unpaired_frames,
           decoder->restarts);
}

/* Frames one after the other: the records that come out, and the counters at the end. */
static void decode(const char *hex)
{
    uint8_t         bytes[FRAMES_MAX * LATCH_FRAME_BYTES];
    latch_decoder_t decoder = {0};
    size_t          count = read_bytes(hex, bytes, sizeof bytes) / LATCH_FRAME_BYTES;
    for (size_t i = 0u; i < count; ++i) {
        take(&decoder, &bytes[i * LATCH_FRAME_BYTES]);
    }
    print_counters(&decoder);
}

static void print_sums(const char *hex)
{
    uint8_t bytes[FRAMES_MAX * LATCH_FRAME_BYTES];
    size_t  count = read_bytes(hex, bytes, sizeof bytes);
    printf("%u %u\n", latch_crc_update(LATCH_CRC_START, bytes, count),
           inject_crc_finish(inject_crc_update(INJECT_CRC_START, bytes, count)));
}

static void parse_command(const char *hex)
{
    uint8_t          frame[INJECT_FRAME_BYTES];
    inject_command_t command;
    if (read_bytes(hex, frame, sizeof frame) != sizeof frame ||
        !inject_frame_get_command(frame, &command)) {
        puts("damaged");
        return;
    }
    printf("Kind=%u Counter=%u WantedPage=%u Line=%u Level=%u ValidMs=%u Count=%u Token=%u "
           "WidthUs=%u PeriodUs=%u DelayUs=%u\n",
           command.kind, command.counter, command.page, command.line, command.level,
           command.valid_ms, command.count, command.token, command.width_us, command.period_us,
           command.delay_us);
}

/* The sum of what follows the key. */
static void print_siphash(const char *hex)
{
    uint8_t bytes[FRAMES_MAX * LATCH_FRAME_BYTES];
    size_t  count = read_bytes(hex, bytes, sizeof bytes) - INJECT_KEY_BYTES;
    printf("%016" PRIx64 "\n", inject_siphash_sum(bytes, &bytes[INJECT_KEY_BYTES], (uint8_t)count));
}

/* ---- a guard, whose clock stands still ---- */

static inject_guard_t guard;

static void begin_guard(const char *hex)
{
    uint8_t key[INJECT_KEY_BYTES];
    inject_guard_begin(&guard, 1u, 1u);
    if (read_bytes(hex, key, sizeof key) == sizeof key) {
        inject_guard_set_key(&guard, key);
    }
}

/* The status frame that answers a command. */
static void guard_take(const char *hex)
{
    uint8_t        frame[INJECT_FRAME_BYTES];
    uint8_t        status[INJECT_FRAME_BYTES];
    size_t         length = read_bytes(hex, frame, sizeof frame);
    inject_order_t order = inject_guard_take(&guard, frame, (uint8_t)length, 0u);
    inject_guard_report(&guard, order.page, order.verdict, 0u, 0u, status);
    print_frame(status);
}

static bool judge(const char *what, const char *hex)
{
    if (strcmp(what, "decode") == 0) {
        decode(hex);
    } else if (strcmp(what, "sums") == 0) {
        print_sums(hex);
    } else if (strcmp(what, "parse") == 0) {
        parse_command(hex);
    } else if (strcmp(what, "siphash") == 0) {
        print_siphash(hex);
    } else if (strcmp(what, "guard") == 0) {
        begin_guard(hex);
    } else if (strcmp(what, "take") == 0) {
        guard_take(hex);
    } else {
        return false;
    }
    return true;
}

/* ---- the command line ---- */

static void read_fields(char *rest, uint64_t field[FIELDS_MAX])
{
    for (unsigned i = 0u; i < FIELDS_MAX; ++i) {
        field[i] = strtoull(rest, &rest, 0);
    }
}

int main(void)
{
    char line[2u * FRAMES_MAX * LATCH_FRAME_BYTES + 32u];
    while (fgets(line, sizeof line, stdin) != NULL) {
        uint64_t field[FIELDS_MAX];
        char    *space = strchr(line, ' ');
        if (space == NULL) {
            return EXIT_FAILURE;
        }
        *space = '\0';
        if (judge(line, space + 1)) {
            (void)fflush(stdout);
            continue;
        }
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
