#include "injector_key.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "say.h"

#define DIGITS    32u /* two to a byte */
#define ENDING    2u  /* a line may end behind them, as on Unix or on Windows */
#define OTHERS    (S_IRWXG | S_IRWXO)
#define NO_DIGIT  0xFFu
#define LETTER_10 10

static uint8_t digit_of(char letter)
{
    if (letter >= '0' && letter <= '9') {
        return (uint8_t)(letter - '0');
    }
    if (letter >= 'a' && letter <= 'f') {
        return (uint8_t)(letter - 'a' + LETTER_10);
    }
    if (letter >= 'A' && letter <= 'F') {
        return (uint8_t)(letter - 'A' + LETTER_10);
    }
    return NO_DIGIT;
}

static bool is_ending(const char *text, size_t length)
{
    return length == 0u || (length == 1u && text[0] == '\n') ||
           (length == ENDING && memcmp(text, "\r\n", ENDING) == 0);
}

static bool parse(const char *text, size_t length, uint8_t *key)
{
    if (length < DIGITS || !is_ending(&text[DIGITS], length - DIGITS)) {
        return false;
    }
    for (size_t i = 0u; i < INJECT_KEY_BYTES; ++i) {
        uint8_t high = digit_of(text[2u * i]);
        uint8_t low = digit_of(text[2u * i + 1u]);
        if (high == NO_DIGIT || low == NO_DIGIT) {
            return false;
        }
        key[i] = (uint8_t)(high << 4 | low);
    }
    return true;
}

/* Nobody but the owner may read it, or it is no secret. */
static bool is_private_file(int fd, const char *path)
{
    struct stat status;
    if (fstat(fd, &status) != 0) {
        say("%s: %s", path, strerror(errno));
        return false;
    }
    if (!S_ISREG(status.st_mode)) {
        say("%s: not a regular file", path);
        return false;
    }
    if ((status.st_mode & OTHERS) != 0u) {
        say("%s: others may read or change this key; chmod 600 it", path);
        return false;
    }
    return true;
}

static bool read_from(int fd, const char *path, uint8_t *key)
{
    char text[DIGITS + ENDING + 1u]; /* one more, to see that it is too long */
    if (!is_private_file(fd, path)) {
        return false;
    }
    ssize_t length = read(fd, text, sizeof text);
    if (length < 0) {
        say("%s: %s", path, strerror(errno));
        return false;
    }
    if (!parse(text, (size_t)length, key)) {
        say("%s: not a key: expected %u hexadecimal digits", path, DIGITS);
        return false;
    }
    return true;
}

bool injector_key_read(const char *path, uint8_t key[INJECT_KEY_BYTES])
{
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK); /* a pipe would be waited for */
    if (fd < 0) {
        say("%s: %s", path, strerror(errno));
        return false;
    }
    bool is_read = read_from(fd, path, key);
    (void)close(fd);
    return is_read;
}
