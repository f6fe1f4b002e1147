#include "pulse_file.h"

#include <errno.h>
#include <stdbool.h>
#include <string.h>

#define MAGIC         "SKLPULS1"
#define MAGIC_BYTES   8u
#define WORD_BYTES    8u
#define CHANNEL_SHIFT 61u
#define TIME_MASK     ((UINT64_C(1) << CHANNEL_SHIFT) - 1u)
#define BYTE_BITS     8u

static bool put_word(FILE *file, uint64_t word)
{
    uint8_t bytes[WORD_BYTES];
    for (unsigned i = 0u; i < WORD_BYTES; ++i) {
        bytes[i] = (uint8_t)(word >> BYTE_BITS * i);
    }
    return fwrite(bytes, sizeof bytes, 1u, file) == 1u;
}

static bool put_head(FILE *file, uint64_t count)
{
    return fwrite(MAGIC, MAGIC_BYTES, 1u, file) == 1u && put_word(file, count);
}

int pulse_file_open(pulse_file_t *pulses, const char *path)
{
    *pulses = (pulse_file_t){.file = fopen(path, "wbe")};
    if (pulses->file == NULL) {
        return errno;
    }
    return put_head(pulses->file, 0u) ? 0 : errno;
}

static bool write_earliest(pulse_file_t *pulses)
{
    bool is_good = put_word(pulses->file, pulses->words[0]);
    --pulses->held;
    memmove(&pulses->words[0], &pulses->words[1], pulses->held * sizeof pulses->words[0]);
    pulses->count += is_good ? 1u : 0u;
    return is_good;
}

int pulse_file_add(pulse_file_t *pulses, uint8_t channel, uint64_t t_ns)
{
    if (pulses->held == PULSE_FILE_HELD && !write_earliest(pulses)) {
        return errno;
    }
    unsigned place = pulses->held;
    for (; place > 0u && (pulses->words[place - 1u] & TIME_MASK) > t_ns; --place) {
        pulses->words[place] = pulses->words[place - 1u];
    }
    pulses->words[place] = t_ns | (uint64_t)channel << CHANNEL_SHIFT;
    ++pulses->held;
    return 0;
}

int pulse_file_close(pulse_file_t *pulses)
{
    bool is_good = true;
    while (pulses->held > 0u) {
        is_good = write_earliest(pulses) && is_good;
    }
    is_good =
        is_good && fseek(pulses->file, 0L, SEEK_SET) == 0 && put_head(pulses->file, pulses->count);
    int error = is_good ? 0 : errno;
    if (fclose(pulses->file) != 0 && error == 0) {
        error = errno;
    }
    return error;
}
