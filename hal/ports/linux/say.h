/* One line to the user on the error stream, with the name of the program in front. */
#ifndef LINUX_SAY_H
#define LINUX_SAY_H

/* The name that stands in front; the text is kept, not copied. */
void say_as(const char *program);

/* Like printf, without the line's end. */
void say(const char *format, ...) __attribute__((format(printf, 1, 2)));

#endif
