/*
 * Registers of the LM3S6965 (Stellaris, Cortex-M3) that this port uses; names and addresses as in
 * its data sheet.
 */
#ifndef CORTEX_M3_LM3S6965_H
#define CORTEX_M3_LM3S6965_H

#include "cortex_m.h"

/* ---- system control ---- */
#define SYSCTL_RIS   REGISTER(0x400FE050u)
#define SYSCTL_RCC   REGISTER(0x400FE060u)
#define SYSCTL_RCGC1 REGISTER(0x400FE104u)
#define SYSCTL_RCGC2 REGISTER(0x400FE108u)

#define RIS_PLL_LOCKED      (1u << 6)
#define RCC_MOSC_ON         0u /* the bit MOSCDIS, clear */
#define RCC_XTAL_8_MHZ      (0xEu << 6)
#define RCC_BYPASS          (1u << 11)
#define RCC_USE_DIVIDER     (1u << 22)
#define RCC_DIVIDE_BY_4     (3u << 23) /* of 200 MHz */
#define RCGC1_UART0         (1u << 0)
#define RCGC1_TIMER(number) (1u << (16u + (number)))
#define RCGC2_GPIO_A        (1u << 0)
#define RCGC2_GPIO_C        (1u << 2)

/* ---- general-purpose timers ---- */
#define TIMER_BASE(number)  (0x40030000u + 0x1000u * (number))
#define TIMER_CFG(number)   REGISTER(TIMER_BASE(number) + 0x000u) /* 0: one of 32 bits */
#define TIMER_TAMR(number)  REGISTER(TIMER_BASE(number) + 0x004u)
#define TIMER_CTL(number)   REGISTER(TIMER_BASE(number) + 0x00Cu)
#define TIMER_IMR(number)   REGISTER(TIMER_BASE(number) + 0x018u)
#define TIMER_ICR(number)   REGISTER(TIMER_BASE(number) + 0x024u)
#define TIMER_TAILR(number) REGISTER(TIMER_BASE(number) + 0x028u)
#define TAMR_ONE_SHOT       1u
#define TAMR_PERIODIC       2u
#define TIMER_A             1u /* its bit in CTL, IMR and ICR */

/* ---- GPIO: PL061 ---- */
#define GPIO_A                0x40004000u
#define GPIO_C                0x40006000u
#define GPIO_DATA(port, mask) REGISTER((port) + ((mask) << 2))
#define GPIO_DIR(port)        REGISTER((port) + 0x400u)
#define GPIO_IS(port)         REGISTER((port) + 0x404u)
#define GPIO_IBE(port)        REGISTER((port) + 0x408u)
#define GPIO_IEV(port)        REGISTER((port) + 0x40Cu)
#define GPIO_IM(port)         REGISTER((port) + 0x410u)
#define GPIO_MIS(port)        REGISTER((port) + 0x418u)
#define GPIO_ICR(port)        REGISTER((port) + 0x41Cu)
#define GPIO_AFSEL(port)      REGISTER((port) + 0x420u)
#define GPIO_DEN(port)        REGISTER((port) + 0x51Cu)

/* ---- UART: PL011 ---- */
#define UART0           0x4000C000u
#define UART_DR(uart)   REGISTER((uart) + 0x000u)
#define UART_FR(uart)   REGISTER((uart) + 0x018u)
#define UART_IBRD(uart) REGISTER((uart) + 0x024u)
#define UART_FBRD(uart) REGISTER((uart) + 0x028u)
#define UART_LCRH(uart) REGISTER((uart) + 0x02Cu)
#define UART_CTL(uart)  REGISTER((uart) + 0x030u)
#define UART_IM(uart)   REGISTER((uart) + 0x038u)
#define UART_ICR(uart)  REGISTER((uart) + 0x044u)
#define FR_RX_EMPTY     (1u << 4)
#define LCRH_8_BITS     (3u << 5)
#define CTL_ENABLE      0x301u /* both ways */
#define UART_TX         (1u << 5)

#define IRQ_GPIO_C 2u
#define IRQ_UART0  5u
#define IRQ_TIMER0 19u
#define IRQ_TIMER1 21u
#define IRQ_TIMER2 23u

#endif
