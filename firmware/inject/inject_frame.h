/*
 * The frames of the injection protocol, docs/INJECTION.md: eight bytes each, numbers little-endian.
 *
 *   byte      0          1     2     3     4     5     6         7
 *   ARM       1          valid_ms    0     0     0     counter   crc
 *   DISARM    2          0     0     0     0     0     counter   crc
 *   PULSE     3          line  level width_us          counter   crc
 *   TRAIN     4          count       period_us         counter   crc
 *   TRIGGER   5          token       delay_us          counter   crc
 *   ASK       6          page  0     0     0     0     counter   crc
 *   SEAL      7          seal                          counter   crc
 *   answer    0          state verdict answered token  counter   crc
 *   counts    page 1-7   first       second      0     counter   crc
 *   challenge 8          challenge                     counter   crc
 *   edge 1    window, level, 0   number   time_ns, low    counter   crc
 *   edge 2    window, level, 1   time_ns, high            counter   crc of both
 *
 * The CRC runs over the CAN id (two bytes, low first) and the seven bytes before it; that of the
 * second half of an edge report carries on from the first half, so halves of different reports
 * never fit.
 */
#ifndef INJECT_FRAME_H
#define INJECT_FRAME_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define INJECT_FRAME_BYTES     8u
#define INJECT_FRAMES_PER_EDGE 2u

#define INJECT_ID_COMMAND 0x300u /* host to injector */
#define INJECT_ID_STATUS  0x301u /* injector to host */
#define INJECT_ID_EDGE    0x302u /* injector to host */

#define INJECT_LINES           8u
#define INJECT_VALID_MAX_MS    60000u
#define INJECT_WIDTH_MAX_US    10000000u
#define INJECT_PERIOD_MAX_US   10000000u
#define INJECT_DELAY_MAX_US    10000000u
#define INJECT_PAGES           6u /* of counts, numbered from 1; page 0 is the answer */
#define INJECT_PAGES_KEYED     8u /* with a key */
#define INJECT_PAGE_CHALLENGE  8u
#define INJECT_SEAL_BYTES      5u
#define INJECT_WINDOW_BITS_MAX 63u

typedef enum {
    INJECT_ARM = 1,     /* ask for a token */
    INJECT_DISARM = 2,  /* drop the token, stop the train */
    INJECT_PULSE = 3,   /* set line, level and width */
    INJECT_TRAIN = 4,   /* set count and period */
    INJECT_TRIGGER = 5, /* play what is set; spends the token */
    INJECT_ASK = 6,     /* change nothing, answer with a page */
    INJECT_SEAL = 7     /* with a key: the seal of the ARM or TRIGGER that follows */
} inject_kind_t;

/* One command; fields that its kind does not have are 0. */
typedef struct {
    uint8_t  kind;      /* inject_kind_t */
    uint8_t  counter;   /* steps by one from command to command, modulo 256 */
    uint8_t  page;      /* ASK: 0 … INJECT_PAGES, with a key INJECT_PAGES_KEYED */
    uint8_t  line;      /* PULSE: 0 … INJECT_LINES - 1 */
    uint8_t  level;     /* PULSE: 0 or 1, the level during the pulse */
    uint16_t valid_ms;  /* ARM: 1 … INJECT_VALID_MAX_MS */
    uint16_t count;     /* TRAIN: pulses, at least 1 */
    uint16_t token;     /* TRIGGER: the last one the injector gave */
    uint32_t width_us;  /* PULSE: 1 … INJECT_WIDTH_MAX_US */
    uint32_t period_us; /* TRAIN: from pulse to pulse; 0 … INJECT_PERIOD_MAX_US */
    uint32_t delay_us;  /* TRIGGER: from its arrival; 0 … INJECT_DELAY_MAX_US */
    uint8_t  seal[INJECT_SEAL_BYTES];
} inject_command_t;

/* What a TRIGGER asks for. */
typedef struct {
    uint8_t  line;
    uint8_t  level;
    uint16_t count;
    uint32_t delay_us;
    uint32_t width_us;
    uint32_t period_us;
} inject_shot_t;

/* What is said to a command. */
typedef struct {
    uint8_t  state;    /* inject_state_t */
    uint8_t  verdict;  /* inject_verdict_t */
    uint8_t  answered; /* counter of the last command in order */
    uint16_t token;    /* for the next TRIGGER; 0 while there is none */
} inject_answer_t;

/* One leading edge that was driven. */
typedef struct {
    uint64_t time_ns;     /* the injector's clock just before it drove the line */
    uint16_t number;      /* counts edges since the start, modulo 2^16 */
    uint8_t  window_bits; /* the edge came within 2^window_bits ns after time_ns */
    uint8_t  level;       /* 0 or 1: the level that was driven */
} inject_edge_t;

/* Write a command. Every field is cut to its width. Any context. */
void inject_frame_put_command(const inject_command_t *command, uint8_t frame[INJECT_FRAME_BYTES]);

/*
 * Read a command. False if the CRC is wrong, and then `command` is not written. Whether kind and
 * figures are in range is for the guard to judge. Any context.
 */
bool inject_frame_get_command(const uint8_t frame[INJECT_FRAME_BYTES], inject_command_t *command);

/* Write an answer as status frame number `counter`. Any context. */
void inject_frame_put_answer(const inject_answer_t *answer, uint8_t counter,
                             uint8_t frame[INJECT_FRAME_BYTES]);

/* Write page `page` of the counts as status frame number `counter`. Any context. */
void inject_frame_put_counts(uint8_t page, uint16_t first, uint16_t second, uint8_t counter,
                             uint8_t frame[INJECT_FRAME_BYTES]);

/* Write page INJECT_PAGE_CHALLENGE as status frame number `counter`. Any context. */
void inject_frame_put_challenge(const uint8_t challenge[INJECT_SEAL_BYTES], uint8_t counter,
                                uint8_t frame[INJECT_FRAME_BYTES]);

/* Write an edge report; its frames are numbered `counter` and `counter` + 1. Any context. */
void inject_frame_put_edge(const inject_edge_t *edge, uint8_t counter,
                           uint8_t frames[INJECT_FRAMES_PER_EDGE][INJECT_FRAME_BYTES]);

#ifdef __cplusplus
}
#endif

#endif
