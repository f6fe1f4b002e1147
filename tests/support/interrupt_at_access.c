#include "interrupt_at_access.h"

#include <stdint.h>
#include <string.h>

#include "fake_critical.h"

/* The hooks must not call themselves. */
#define BARE __attribute__((no_sanitize_thread))

static interrupt_t *handler;
static unsigned     due_at[INTERRUPTS_MAX];
static unsigned     due_count;
static unsigned     runs;
static unsigned     accesses;
static unsigned     unmasked;
static uintptr_t    watched;
static size_t       watched_size;
static bool         is_active;

BARE void interrupt_watch(const void *object, size_t size)
{
    watched = (uintptr_t)object;
    watched_size = size;
}

BARE void interrupt_begin(interrupt_t *interrupt, const unsigned *at, unsigned count)
{
    handler = interrupt;
    due_count = count;
    for (unsigned i = 0u; i < count; ++i) {
        due_at[i] = at[i];
    }
    runs = 0u;
    accesses = 0u;
    unmasked = 0u;
    is_active = true;
}

BARE unsigned interrupt_end(void)
{
    is_active = false;
    return accesses;
}

BARE unsigned interrupt_runs(void)
{
    return runs;
}

BARE unsigned interrupt_unmasked_accesses(void)
{
    return unmasked;
}

BARE static void run_due(unsigned number_of_accesses)
{
    while (runs < due_count && due_at[runs] < number_of_accesses) {
        unsigned number = runs;
        ++runs;
        handler(number);
    }
}

/* Neither the interrupt nor what is asked here is code to be interrupted. */
BARE void interrupt_on_unmask(void)
{
    if (is_active) {
        is_active = false;
        run_due(accesses);
        is_active = true;
    }
}

BARE static void judge_access(uintptr_t begin, size_t size)
{
    if (fake_critical_is_masked()) {
        return;
    }
    if (begin < watched + watched_size && watched < begin + size) {
        ++unmasked;
    }
    run_due(accesses);
}

BARE static void on_access(const void *address, size_t size)
{
    if (is_active) {
        is_active = false;
        ++accesses;
        judge_access((uintptr_t)address, size);
        is_active = true;
    }
}

/* ---- what the compiler calls ---- */

#define HOOK(name, size)           \
    void      name(void *address); \
    BARE void name(void *address)  \
    {                              \
        on_access(address, size);  \
    }

#define HOOKS(kind)            \
    HOOK(__tsan_##kind##1, 1u) \
    HOOK(__tsan_##kind##2, 2u) \
    HOOK(__tsan_##kind##4, 4u) \
    HOOK(__tsan_##kind##8, 8u) \
    HOOK(__tsan_##kind##16, 16u)

HOOKS(read)
HOOKS(write)
HOOKS(read_write)
HOOKS(unaligned_read)
HOOKS(unaligned_write)
HOOKS(unaligned_read_write)
HOOKS(volatile_read)
HOOKS(volatile_write)

void __tsan_read_range(void *address, size_t size);
void __tsan_write_range(void *address, size_t size);
void __tsan_init(void);
void __tsan_func_entry(void *caller);
void __tsan_func_exit(void);

BARE void __tsan_read_range(void *address, size_t size)
{
    on_access(address, size);
}

BARE void __tsan_write_range(void *address, size_t size)
{
    on_access(address, size);
}

BARE void __tsan_init(void)
{
}

BARE void __tsan_func_entry(void *caller)
{
    (void)caller;
}

BARE void __tsan_func_exit(void)
{
}

/* What clang puts in place of the C library's. */
void *__tsan_memcpy(void *to, const void *from, size_t size);
void *__tsan_memset(void *to, int byte, size_t size);

BARE void *__tsan_memcpy(void *to, const void *from, size_t size)
{
    on_access(from, size);
    on_access(to, size);
    return memcpy(to, from, size);
}

BARE void *__tsan_memset(void *to, int byte, size_t size)
{
    on_access(to, size);
    return memset(to, byte, size);
}

/* With coverage switched on, the counters of the lines are atomic. They are no access of the code.
 */
int64_t __tsan_atomic64_fetch_add(volatile int64_t *counter, int64_t by, int order);

BARE int64_t __tsan_atomic64_fetch_add(volatile int64_t *counter, int64_t by, int order)
{
    (void)order;
    int64_t before = *counter;
    *counter = before + by;
    return before;
}
