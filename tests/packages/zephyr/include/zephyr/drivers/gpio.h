/* Stand-in: the part of Zephyr's header that the example uses. */
#pragma once
#include <stdint.h>

struct device;
struct gpio_dt_spec {
    const struct device *port;
    uint8_t              pin;
};
struct gpio_callback {
    void (*handler)(const struct device *, struct gpio_callback *, uint32_t);
};
#define DT_ALIAS(name)                DT_N_ALIAS_##name
#define GPIO_DT_SPEC_GET(node, name)  {(const struct device *)0, 3u}
#define GPIO_INPUT              1u
#define GPIO_INT_EDGE_TO_ACTIVE 2u
#define GPIO_INT_DISABLE        4u

int  gpio_pin_configure_dt(const struct gpio_dt_spec *spec, uint32_t flags);
int  gpio_pin_interrupt_configure_dt(const struct gpio_dt_spec *spec, uint32_t flags);
int  gpio_pin_get_dt(const struct gpio_dt_spec *spec);
int  gpio_add_callback(const struct device *port, struct gpio_callback *callback);
void gpio_init_callback(struct gpio_callback *callback,
                        void (*handler)(const struct device *, struct gpio_callback *, uint32_t),
                        uint32_t pins);
