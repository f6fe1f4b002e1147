#include "chip.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "say.h"

#define DEVICES   "/dev/"
#define PREFIX    "gpiochip"
#define PATH_SIZE 300u

static struct gpiod_chip *open_below_dev(const char *name)
{
    char path[PATH_SIZE];
    (void)snprintf(path, sizeof path, DEVICES "%s", name);
    return gpiod_chip_open(path);
}

static int has_label(struct gpiod_chip *chip, const char *label)
{
    struct gpiod_chip_info *info = gpiod_chip_get_info(chip);
    int found = info != NULL && strcmp(gpiod_chip_info_get_label(info), label) == 0;
    gpiod_chip_info_free(info);
    return found;
}

static struct gpiod_chip *open_if_labelled(const char *name, const char *label)
{
    struct gpiod_chip *chip = NULL;
    if (strncmp(name, PREFIX, strlen(PREFIX)) == 0) {
        chip = open_below_dev(name);
    }
    if (chip != NULL && !has_label(chip, label)) {
        gpiod_chip_close(chip);
        chip = NULL;
    }
    return chip;
}

static struct gpiod_chip *open_by_label(const char *label)
{
    DIR               *folder = opendir(DEVICES);
    struct gpiod_chip *chip = NULL;
    while (folder != NULL && chip == NULL) {
        const struct dirent *entry =
            readdir(folder); /* NOLINT(concurrency-mt-unsafe): one thread */
        if (entry == NULL) {
            break;
        }
        chip = open_if_labelled(entry->d_name, label);
    }
    if (folder != NULL) {
        (void)closedir(folder);
    }
    if (chip == NULL) {
        errno = ENOENT;
    }
    return chip;
}

struct gpiod_chip *chip_open(const char *name)
{
    if (strchr(name, '/') != NULL) {
        return gpiod_chip_open(name);
    }
    struct gpiod_chip *chip = open_below_dev(name);
    return chip != NULL || errno != ENOENT ? chip : open_by_label(name);
}

void chip_explain(const char *name, int error)
{
    switch (error) {
    case ENOENT:
        say("no GPIO chip \"%s\"; see: gpiodetect, or ls " DEVICES PREFIX
            "*; for a simulated one: modprobe gpio-sim",
            name);
        break;
    case EACCES:
    case EPERM:
        say("no permission on GPIO chip \"%s\"; run as root, or join the group of the device: "
            "ls -l " DEVICES PREFIX "*",
            name);
        break;
    case ENOTTY:
    case ENODEV:
        say("\"%s\" is no GPIO chip; see: gpiodetect", name);
        break;
    default:
        say("GPIO chip \"%s\": %s", name, strerror(error));
        break;
    }
}

static void explain_busy(struct gpiod_chip *chip, const char *name, uint32_t offset)
{
    struct gpiod_line_info *info = gpiod_chip_get_line_info(chip, offset);
    const char             *user = info != NULL ? gpiod_line_info_get_consumer(info) : NULL;
    say("line %u of \"%s\" is in use by \"%s\"; end that program, or choose another: gpioinfo",
        offset, name, user != NULL ? user : "?");
    gpiod_line_info_free(info);
}

static size_t line_count(struct gpiod_chip *chip)
{
    struct gpiod_chip_info *info = gpiod_chip_get_info(chip);
    size_t                  count = info != NULL ? gpiod_chip_info_get_num_lines(info) : 0u;
    gpiod_chip_info_free(info);
    return count;
}

void chip_explain_line(struct gpiod_chip *chip, const char *name, uint32_t offset, int error)
{
    size_t lines = line_count(chip);
    if (error == EBUSY) {
        explain_busy(chip, name, offset);
    } else if (offset >= lines) {
        say("\"%s\" has no line %u, only 0 to %zu; see: gpioinfo", name, offset, lines - 1u);
    } else {
        say("line %u of \"%s\" cannot be had: %s; without --bias and --debounce-us?", offset, name,
            strerror(error));
    }
}
