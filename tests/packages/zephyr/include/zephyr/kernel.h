/* Stand-in: the part of Zephyr's header that the example uses. */
#pragma once
#include <stdint.h>

#define ARG_UNUSED(x) (void)(x)
#define BIT(n)        (1u << (n))
#define BUILD_ASSERT(holds, text) _Static_assert(holds, text)
#ifndef CONFIG_SYS_CLOCK_TICKS_PER_SEC
#define CONFIG_SYS_CLOCK_TICKS_PER_SEC 100 /* as without a prj.conf of one's own */
#endif

unsigned irq_lock(void);
void     irq_unlock(unsigned key);
uint32_t k_cycle_get_32(void);
uint32_t k_us_to_cyc_ceil32(uint32_t us);
int32_t  k_msleep(int32_t ms);
void     printk(const char *format, ...);
