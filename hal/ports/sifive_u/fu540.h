/* Registers of the FU540 that this port uses; names and addresses as in its manual. */
#ifndef SIFIVE_U_FU540_H
#define SIFIVE_U_FU540_H

#include "riscv.h"

#define UART0          0x10010000u
#define UART_TX(uart)  REGISTER((uart) + 0x00u)
#define UART_RX(uart)  REGISTER((uart) + 0x04u)
#define UART_TXC(uart) REGISTER((uart) + 0x08u)
#define UART_RXC(uart) REGISTER((uart) + 0x0Cu)
#define UART_IE(uart)  REGISTER((uart) + 0x10u)
#define UART_DIV(uart) REGISTER((uart) + 0x18u)
#define RX_EMPTY       (1u << 31)
#define TXC_ENABLE     1u
#define TXC_BELOW(n)   ((n) << 16) /* an interrupt while fewer wait */
#define RXC_ENABLE     1u
#define IE_TX          1u

#define PWM0            0x10020000u
#define PWM1            0x10021000u
#define PWM_CFG(pwm)    REGISTER((pwm) + 0x00u)
#define PWM_COUNT(pwm)  REGISTER((pwm) + 0x08u)
#define PWM_CMP(pwm, n) REGISTER((pwm) + 0x20u + 4u * (n))
#define PWM_RUN         (1u << 12)
#define PWM_RUN_ONCE  (1u << 13 | 1u << 9) /* until the first compare, which sets the count to 0 */
#define PWM_SCALE_MAX 15u

#define GPIO_VALUE    REGISTER(0x10060000u)
#define GPIO_INPUT_EN REGISTER(0x10060004u)
#define GPIO_RISE_IE  REGISTER(0x10060018u)
#define GPIO_RISE_IP  REGISTER(0x1006001Cu)
#define GPIO_FALL_IE  REGISTER(0x10060020u)
#define GPIO_FALL_IP  REGISTER(0x10060024u)

#define IRQ_UART0     4u
#define IRQ_GPIO(pin) (7u + (pin))

#endif
