/*
 * What makes the kernel run this program when it is due: a processor of its own, a real-time
 * priority, memory that stays in place. Each returns 0, or an errno after a line that says what is
 * missing and how to get it.
 */
#ifndef LINUX_REALTIME_H
#define LINUX_REALTIME_H

/* Run on processor `cpu` only. */
int realtime_pin(int cpu);

/* SCHED_FIFO at `priority`, 1 to 99. */
int realtime_fifo(int priority);

/* Keep all memory, present and future, from being paged out. */
int realtime_lock_memory(void);

#endif
