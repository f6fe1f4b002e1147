#include "injector_line.h"

#include <errno.h>
#include <fcntl.h>
#include <gpiod.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "chip.h"
#include "say.h"

#define CONSUMER   "skiplatch-injector"
#define NAME_SIZE  256u
#define OFFSET_MAX 65535ul

static enum gpiod_line_value value_of(bool level)
{
    return level ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE;
}

/* Split CHIP:OFFSET at its last colon. */
static bool parse_name(const char *name, char chip[NAME_SIZE], uint32_t *offset)
{
    const char *colon = strrchr(name, ':');
    if (colon == NULL || colon == name || (size_t)(colon - name) >= NAME_SIZE) {
        return false;
    }
    char *end = NULL;
    errno = 0;
    unsigned long number = strtoul(colon + 1, &end, 10);
    if (errno != 0 || colon[1] < '0' || colon[1] > '9' || *end != '\0' || number > OFFSET_MAX) {
        return false;
    }
    memcpy(chip, name, (size_t)(colon - name));
    chip[colon - name] = '\0';
    *offset = (uint32_t)number;
    return true;
}

static bool fill_config(struct gpiod_line_config *config, struct gpiod_line_settings *settings,
                        uint32_t offset, bool level)
{
    return gpiod_line_settings_set_direction(settings, GPIOD_LINE_DIRECTION_OUTPUT) == 0 &&
           gpiod_line_settings_set_output_value(settings, value_of(level)) == 0 &&
           gpiod_line_config_add_line_settings(config, &offset, 1u, settings) == 0;
}

static struct gpiod_line_request *request_output(struct gpiod_chip *chip, uint32_t offset,
                                                 bool level)
{
    struct gpiod_line_config    *config = gpiod_line_config_new();
    struct gpiod_line_settings  *settings = gpiod_line_settings_new();
    struct gpiod_request_config *request = gpiod_request_config_new();
    struct gpiod_line_request   *line = NULL;
    if (config != NULL && settings != NULL && request != NULL &&
        fill_config(config, settings, offset, level)) {
        gpiod_request_config_set_consumer(request, CONSUMER);
        line = gpiod_chip_request_lines(chip, request, config);
    }
    int error = errno; /* of the request, not of what is freed */
    gpiod_request_config_free(request);
    gpiod_line_settings_free(settings);
    gpiod_line_config_free(config);
    errno = error;
    return line;
}

bool injector_line_open_output(injector_line_t *line, const char *name, bool level)
{
    char chip_name[NAME_SIZE];
    *line = (injector_line_t){.pull_fd = -1};
    if (!parse_name(name, chip_name, &line->offset)) {
        say("--line: expected CHIP:OFFSET, such as gpiochip0:17, got \"%s\"", name);
        return false;
    }
    struct gpiod_chip *chip = chip_open(chip_name);
    if (chip == NULL) {
        chip_explain(chip_name, errno);
        return false;
    }
    line->output = request_output(chip, line->offset, level);
    if (line->output == NULL) {
        chip_explain_line(chip, chip_name, line->offset, errno);
    }
    gpiod_chip_close(chip);
    return line->output != NULL;
}

static void explain_pull(const char *path, int error)
{
    switch (error) {
    case ENOENT:
    case ENOTDIR:
        say("no file \"%s\"; modprobe gpio-sim, then make a chip under "
            "/sys/kernel/config/gpio-sim",
            path);
        break;
    case EACCES:
    case EPERM:
        say("no permission on \"%s\"; run as root", path);
        break;
    default:
        say("\"%s\" is no pull of gpio-sim: %s", path, strerror(error));
        break;
    }
}

bool injector_line_open_pull(injector_line_t *line, const char *path, bool level)
{
    *line = (injector_line_t){.pull_fd = open(path, O_WRONLY | O_CLOEXEC)};
    if (line->pull_fd < 0 || !injector_line_set(line, level)) {
        explain_pull(path, errno);
        injector_line_close(line);
        return false;
    }
    return true;
}

static bool set_pull(int fd, bool level)
{
    const char *text = level ? "pull-up" : "pull-down";
    size_t      length = strlen(text);
    return pwrite(fd, text, length, 0) == (ssize_t)length;
}

bool injector_line_set(const injector_line_t *line, bool level)
{
    if (line->output == NULL) {
        return set_pull(line->pull_fd, level);
    }
    return gpiod_line_request_set_value(line->output, line->offset, value_of(level)) == 0;
}

void injector_line_close(injector_line_t *line)
{
    if (line->output != NULL) {
        gpiod_line_request_release(line->output);
    }
    if (line->pull_fd >= 0) {
        (void)close(line->pull_fd);
    }
    *line = (injector_line_t){.pull_fd = -1};
}
