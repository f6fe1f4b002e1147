#include "reset.h"

#include <stdint.h>

/* Of the linker script. */
extern const uint32_t link_data_load[];
extern uint32_t       link_data_start[];
extern uint32_t       link_data_end[];
extern uint32_t       link_bss_end[];

int main(void);

void stay(void)
{
    for (;;) {
    }
}

void reset(void)
{
    const uint32_t *from = link_data_load;
    uint32_t       *to = link_data_start;
    while (to < link_data_end) {
        *to++ = *from++;
    }
    while (to < link_bss_end) {
        *to++ = 0u;
    }
    (void)main();
    stay();
}
