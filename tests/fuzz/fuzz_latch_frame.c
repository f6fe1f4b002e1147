/*
 * Fuzzes the receiving side of the report. The first byte picks one of three games: frames of
 * arbitrary bytes, a stream of arbitrary bytes, or a script of what a bad bus does to good frames.
 */
/* LINK: firmware/report/latch_frame.c firmware/report/latch_stream.c firmware/report/latch_crc.c */
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "report/latch_frame.h"
#include "report/latch_stream.h"

#define SCRIPT_FRAMES_MAX 512u
#define SEQUENCE_START    0x7FF0u /* the wrap is soon reached */
#define RESERVED_BIT      0x80u   /* of byte 1 of a first half: not sent, not looked at */

#define CHECK(condition)                                                            \
    do {                                                                            \
        if (!(condition)) {                                                         \
            fprintf(stderr, "%s:%d: not so: %s\n", __FILE__, __LINE__, #condition); \
            abort();                                                                \
        }                                                                           \
    } while (false)

typedef uint8_t pair_t[LATCH_FRAMES_PER_RECORD][LATCH_FRAME_BYTES];

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static latch_record_t record_of(uint16_t sequence)
{
    return (latch_record_t){
        .ticks = sequence * 2654435761u,
        .position_counts = (int32_t)(sequence * 40503u) - 1000000,
        .sequence = sequence & LATCH_SEQUENCE_MASK,
        .channel = sequence & LATCH_CHANNEL_MAX,
        .flags = sequence >> 3 & 0x07u,
    };
}

static bool is_same(const latch_record_t *a, const latch_record_t *b)
{
    return a->ticks == b->ticks && a->position_counts == b->position_counts &&
           a->sequence == b->sequence && a->channel == b->channel && a->flags == b->flags;
}

/* The number of the next new record. */
static uint16_t next_sequence(const latch_decoder_t *decoder)
{
    return decoder->any_record ? (decoder->last_sequence + 1u) & LATCH_SEQUENCE_MASK : 0u;
}

/* ---- arbitrary frames ---- */

/* What was made of the frame shows in the counters, and nothing else does. */
static void check_counters(const latch_decoder_t *before, const latch_decoder_t *after,
                           latch_frame_result_t result)
{
    bool was_waiting = before->has_first;
    int  damaged = after->damaged_frames - before->damaged_frames;
    int  repeated = after->repeated_frames - before->repeated_frames;
    int  unpaired = after->unpaired_frames - before->unpaired_frames;

    CHECK(damaged == (result == LATCH_FRAME_DAMAGED));
    CHECK(result == LATCH_FRAME_REPEATED ? repeated == 1 || repeated == 2 : repeated == 0);
    CHECK(result == LATCH_FRAME_UNPAIRED  ? unpaired == 1
          : result == LATCH_FRAME_PARTIAL ? unpaired == was_waiting
                                          : unpaired == 0);
    CHECK(result == LATCH_FRAME_RECORD || after->lost_records == before->lost_records);
    CHECK(after->lost_records >= before->lost_records);
}

/* A record that came out is the one that went in. */
static void check_record(const uint8_t *first, const uint8_t *second, const latch_record_t *record)
{
    pair_t frames;
    latch_frame_encode(record, frames);
    if ((first[1] & RESERVED_BIT) == 0u) {
        CHECK(memcmp(first, frames[0], LATCH_FRAME_BYTES) == 0);
        CHECK(memcmp(second, frames[1], LATCH_FRAME_BYTES) == 0);
    }
}

/* Whatever came before, a good record gets through. */
static void check_still_works(latch_decoder_t *decoder)
{
    latch_record_t sent = record_of(next_sequence(decoder));
    latch_record_t received;
    pair_t         frames;
    latch_frame_encode(&sent, frames);
    (void)latch_frame_decode(decoder, frames[0], &received);
    CHECK(latch_frame_decode(decoder, frames[1], &received) == LATCH_FRAME_RECORD);
    CHECK(is_same(&sent, &received));
}

static void play_frames(const uint8_t *data, size_t size)
{
    latch_decoder_t decoder = {0};
    for (; size >= LATCH_FRAME_BYTES; data += LATCH_FRAME_BYTES, size -= LATCH_FRAME_BYTES) {
        latch_decoder_t      before = decoder;
        latch_record_t       record;
        latch_frame_result_t result = latch_frame_decode(&decoder, data, &record);
        check_counters(&before, &decoder, result);
        if (result == LATCH_FRAME_RECORD) {
            check_record(before.first, data, &record);
        }
    }
    check_still_works(&decoder);
}

/* ---- an arbitrary stream ---- */

static unsigned feed(latch_stream_t *stream, const uint8_t *bytes, size_t size,
                     latch_record_t *record)
{
    unsigned records = 0u;
    for (size_t i = 0u; i < size; ++i) {
        records += latch_stream_take(stream, bytes[i], record);
        CHECK(stream->filled < LATCH_FRAME_BYTES);
    }
    return records;
}

/* Each byte is part of a good frame, skipped, or still waiting. */
static void check_bytes(const latch_stream_t *stream, size_t fed)
{
    size_t in_frames = fed - stream->skipped_bytes - stream->filled;
    CHECK(stream->skipped_bytes + stream->filled <= fed);
    CHECK(in_frames % LATCH_FRAME_BYTES == 0u);
}

/* What follows garbage may be eaten with it; the third record is not. */
static void check_stream_still_works(latch_stream_t *stream)
{
    latch_record_t received;
    latch_record_t sent;
    unsigned       records = 0u;
    for (unsigned i = 0u; i < 3u; ++i) {
        pair_t frames;
        sent = record_of((next_sequence(&stream->decoder) + i) & LATCH_SEQUENCE_MASK);
        latch_frame_encode(&sent, frames);
        records = feed(stream, frames[0], sizeof frames, &received);
    }
    CHECK(records == 1u);
    CHECK(is_same(&sent, &received));
}

static void play_stream(const uint8_t *data, size_t size)
{
    latch_stream_t stream = {0};
    latch_record_t record;
    (void)feed(&stream, data, size, &record);
    check_bytes(&stream, size);
    check_stream_still_works(&stream);
}

/* ---- a bad bus ---- */

typedef struct {
    latch_decoder_t decoder;
    uint8_t         frames[SCRIPT_FRAMES_MAX][LATCH_FRAME_BYTES]; /* sent so far */
    unsigned        sent;
    unsigned        received; /* records */
    uint16_t        first_received;
    bool            has_collided; /* a damaged frame had the right CRC: all bets are off */
} bus_t;

static void arrive(bus_t *bus, const uint8_t *frame)
{
    latch_record_t record;
    if (latch_frame_decode(&bus->decoder, frame, &record) != LATCH_FRAME_RECORD) {
        return;
    }
    latch_record_t expected = record_of(record.sequence);
    uint16_t       age = (SEQUENCE_START + bus->sent / 2u - record.sequence) & LATCH_SEQUENCE_MASK;
    CHECK(is_same(&expected, &record));
    CHECK(age <= bus->sent / 2u);
    if (bus->received == 0u) {
        bus->first_received = record.sequence;
    }
    ++bus->received;
}

/* The next frame of the sender. */
static const uint8_t *send(bus_t *bus)
{
    pair_t         frames;
    uint16_t       sequence = (SEQUENCE_START + bus->sent / 2u) & LATCH_SEQUENCE_MASK;
    latch_record_t record = record_of(sequence);
    latch_frame_encode(&record, frames);
    memcpy(bus->frames[bus->sent], frames[bus->sent % 2u], LATCH_FRAME_BYTES);
    return bus->frames[bus->sent++];
}

static void arrive_damaged(bus_t *bus, const uint8_t *frame, uint8_t where, uint8_t what)
{
    uint8_t damaged[LATCH_FRAME_BYTES];
    memcpy(damaged, frame, sizeof damaged);
    damaged[where % LATCH_FRAME_BYTES] ^= what;
    damaged[where / LATCH_FRAME_BYTES % LATCH_FRAME_BYTES] ^= (uint8_t)(what >> 1);
    if (memcmp(damaged, frame, sizeof damaged) != 0 &&
        latch_frame_is_good(&bus->decoder, damaged)) {
        bus->has_collided = true;
        return;
    }
    arrive(bus, damaged);
}

static void arrive_again(bus_t *bus, unsigned age)
{
    if (bus->sent > 0u) {
        arrive(bus, bus->frames[bus->sent - 1u - age % bus->sent]);
    }
}

/* The later of two frames comes first. */
static void arrive_swapped(bus_t *bus)
{
    const uint8_t *earlier = send(bus);
    const uint8_t *later = send(bus);
    arrive(bus, later);
    arrive(bus, earlier);
}

/* One step of the script; the upper bits of `step` say how. */
static void play_step(bus_t *bus, uint8_t step, uint8_t more)
{
    switch (step % 8u) {
    case 0u:
        (void)send(bus);
        break;
    case 1u:
        arrive_damaged(bus, send(bus), step / 8u, more);
        break;
    case 2u:
        arrive(bus, send(bus));
        arrive_again(bus, 0u);
        break;
    case 3u:
        arrive_again(bus, more);
        break;
    case 4u:
        arrive_swapped(bus);
        break;
    default:
        arrive(bus, send(bus));
        break;
    }
}

/* Between the first and the last record received, each one was received or counted as lost. */
static void check_nothing_uncounted(const bus_t *bus)
{
    uint16_t span = (bus->decoder.last_sequence - bus->first_received) & LATCH_SEQUENCE_MASK;
    CHECK(bus->received + bus->decoder.lost_records == span + 1u);
}

static void play_script(const uint8_t *data, size_t size)
{
    static bus_t bus;
    bus = (bus_t){.sent = 0u};
    for (size_t i = 0u; i + 1u < size && bus.sent + 4u < SCRIPT_FRAMES_MAX; i += 2u) {
        play_step(&bus, data[i], data[i + 1u]);
    }
    if (bus.has_collided) {
        return;
    }
    if (bus.sent % 2u != 0u) {
        (void)send(&bus); /* the second half of a record whose first half may not have come */
    }
    unsigned before = bus.received;
    arrive(&bus, send(&bus));
    arrive(&bus, send(&bus));
    CHECK(bus.received == before + 1u);
    check_nothing_uncounted(&bus);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size == 0u) {
        return 0;
    }
    switch (data[0] % 3u) {
    case 0u:
        play_frames(&data[1], size - 1u);
        break;
    case 1u:
        play_stream(&data[1], size - 1u);
        break;
    default:
        play_script(&data[1], size - 1u);
        break;
    }
    return 0;
}
