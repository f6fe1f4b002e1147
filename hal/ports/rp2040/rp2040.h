/*
 * Registers of the RP2040 (Cortex-M0+) that this port uses; names and addresses as in its data
 * sheet. Those of APB can be changed by bits: what is written to an alias is set or cleared.
 */
#ifndef RP2040_RP2040_H
#define RP2040_RP2040_H

#include "cortex_m.h"

#define SET_OF(address)   REGISTER((address) + 0x2000u)
#define CLEAR_OF(address) REGISTER((address) + 0x3000u)

/* ---- resets, clocks ---- */
#define RESETS_RESET         0x4000C000u
#define RESETS_DONE          REGISTER(0x4000C008u)
#define RESET_IO_BANK0       (1u << 5)
#define RESET_PADS_BANK0     (1u << 8)
#define RESET_PLL_SYS        (1u << 12)
#define RESET_PWM            (1u << 14)
#define RESET_TIMER          (1u << 21)
#define RESET_UART0          (1u << 22)
#define XOSC_CTRL            REGISTER(0x40024000u)
#define XOSC_STATUS          REGISTER(0x40024004u)
#define XOSC_STARTUP         REGISTER(0x4002400Cu)
#define XOSC_ON_12_MHZ       0xFABAA0u
#define XOSC_STABLE          (1u << 31)
#define XOSC_STARTUP_1_MS    47u /* times 256 cycles */
#define PLL_SYS_CS           REGISTER(0x40028000u)
#define PLL_SYS_PWR          0x40028004u
#define PLL_SYS_FBDIV        REGISTER(0x40028008u)
#define PLL_SYS_PRIM         REGISTER(0x4002800Cu)
#define PLL_LOCKED           (1u << 31)
#define PLL_REFERENCE_BY_1   1u
#define PWR_OFF              (1u << 0)
#define PWR_DIVIDER_OFF      (1u << 3)
#define PWR_OSCILLATOR_OFF   (1u << 5)
#define PRIM_BY(first, then) ((first) << 16 | (then) << 12)
#define CLK_REF_CTRL         REGISTER(0x40008030u)
#define CLK_REF_SELECTED     REGISTER(0x40008038u)
#define CLK_SYS_CTRL         REGISTER(0x4000803Cu)
#define CLK_SYS_SELECTED     REGISTER(0x40008044u)
#define CLK_PERI_CTRL        REGISTER(0x40008048u)
#define REF_FROM_XOSC        2u
#define SYS_FROM_PLL         1u
#define PERI_FROM_SYS        (1u << 11)
#define WATCHDOG_TICK        REGISTER(0x4005802Cu)
#define TICK_ON              (1u << 9)

/* ---- pins ---- */
#define IO_CTRL(pin)   REGISTER(0x40014004u + 8u * (pin))
#define IO_UART        2u
#define IO_SIO         5u
#define PADS(pin)      REGISTER(0x4001C004u + 4u * (pin))
#define PAD_SCHMITT    (1u << 1)
#define PAD_PULL_DOWN  (1u << 2)
#define PAD_PULL_UP    (1u << 3)
#define PAD_4_MA       (1u << 4)
#define PAD_INPUT      (1u << 6)
#define SIO_GPIO_IN    REGISTER(0xD0000004u)
#define SIO_GPIO_SET   REGISTER(0xD0000014u)
#define SIO_GPIO_CLEAR REGISTER(0xD0000018u)
#define SIO_OE_SET     REGISTER(0xD0000024u)

/* Events of the pins 0 … 7, four bits each; which of them interrupt whom, each core for itself. */
#define IO_INTR0         REGISTER(0x400140F0u)
#define IO_INTE0(core)   (0x40014100u + 0x30u * (core))
#define IO_INTS0(core)   REGISTER(0x40014120u + 0x30u * (core))
#define EVENT_FALLS(pin) (1u << (4u * (pin) + 2u))
#define EVENT_RISES(pin) (1u << (4u * (pin) + 3u))

/* ---- from core to core ---- */
#define SIO_FIFO_ST   REGISTER(0xD0000050u)
#define SIO_FIFO_WR   REGISTER(0xD0000054u)
#define SIO_FIFO_RD   REGISTER(0xD0000058u)
#define FIFO_HAS_WORD (1u << 0)
#define FIFO_HAS_ROOM (1u << 1)

/* ---- the timer of 1 µs ---- */
#define TIMER_ALARM0   REGISTER(0x40054010u)
#define TIMER_TIMERAWL REGISTER(0x40054028u)
#define TIMER_INTR     REGISTER(0x40054034u)
#define TIMER_INTE     REGISTER(0x40054038u)
#define ALARM_0        (1u << 0)

/* ---- PWM ---- */
#define PWM_CSR(slice)   REGISTER(0x40050000u + 0x14u * (slice))
#define PWM_DIV(slice)   REGISTER(0x40050004u + 0x14u * (slice))
#define PWM_CTR(slice)   REGISTER(0x40050008u + 0x14u * (slice))
#define PWM_TOP(slice)   REGISTER(0x40050010u + 0x14u * (slice))
#define PWM_INTR         REGISTER(0x400500A4u)
#define PWM_INTE         REGISTER(0x400500A8u)
#define PWM_RUN          1u
#define PWM_BY(cycles)   ((cycles) << 4)
#define PWM_SLICE(slice) (1u << (slice))

/* ---- UART (PL011) ---- */
#define UART0_DR    REGISTER(0x40034000u)
#define UART0_FR    REGISTER(0x40034018u)
#define UART0_IBRD  REGISTER(0x40034024u)
#define UART0_FBRD  REGISTER(0x40034028u)
#define UART0_LCRH  REGISTER(0x4003402Cu)
#define UART0_CR    REGISTER(0x40034030u)
#define UART0_IMSC  REGISTER(0x40034038u)
#define UART0_ICR   REGISTER(0x40034044u)
#define FR_RX_EMPTY (1u << 4)
#define LCRH_8_BITS (3u << 5)
#define CR_ENABLE   0x301u /* both ways */
#define UART_TX     (1u << 5)

#define IRQ_TIMER_0  0u
#define IRQ_PWM_WRAP 4u
#define IRQ_IO_BANK0 13u
#define IRQ_UART0    20u
#define IRQ_COUNT    32u

#endif
