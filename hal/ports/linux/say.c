#include "say.h"

#include <stdarg.h>
#include <stdio.h>

static const char *name = "skiplatch";

void say_as(const char *program)
{
    name = program;
}

void say(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    (void)fprintf(stderr, "%s: ", name);
    (void)vfprintf(stderr, format, arguments);
    (void)fputc('\n', stderr);
    va_end(arguments);
}
