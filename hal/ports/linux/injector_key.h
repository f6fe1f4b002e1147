/* Reads the key of the injection protocol from a file of 32 hexadecimal digits. */
#ifndef LINUX_INJECTOR_KEY_H
#define LINUX_INJECTOR_KEY_H

#include <stdbool.h>
#include <stdint.h>

#include "inject/inject_seal.h"

/*
 * Read the key. False after a line that says why not: the file cannot be read, is no regular one,
 * may be read by others, or holds anything else. The line never shows what stands in the file.
 */
bool injector_key_read(const char *path, uint8_t key[INJECT_KEY_BYTES]);

#endif
