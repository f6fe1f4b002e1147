/* The start and the end of a program. */
#ifndef QEMU_RESET_H
#define QEMU_RESET_H

/* With a stack: memory as C wants it, then main(). */
void reset(void);

/* Faults end here: a debugger finds the program, with what led to it on the stack. */
void stay(void);

#endif
