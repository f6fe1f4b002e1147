/*
 * Registers of the STM32F405 (Cortex-M4) that this port uses; names and addresses as in its
 * reference manual, RM0090.
 */
#ifndef STM32F4_STM32F405_H
#define STM32F4_STM32F405_H

#include "cortex_m.h"

/* ---- reset and clock control, flash ---- */
#define RCC_CR             REGISTER(0x40023800u)
#define RCC_PLLCFGR        REGISTER(0x40023804u)
#define RCC_CFGR           REGISTER(0x40023808u)
#define RCC_AHB1ENR        REGISTER(0x40023830u)
#define RCC_APB1ENR        REGISTER(0x40023840u)
#define RCC_APB2ENR        REGISTER(0x40023844u)
#define FLASH_ACR          REGISTER(0x40023C00u)
#define CR_HSE_ON          (1u << 16)
#define CR_HSE_READY       (1u << 17)
#define CR_PLL_ON          (1u << 24)
#define CR_PLL_READY       (1u << 25)
#define PLL_OF_HSE         (1u << 22)
#define PLL_DIVIDE(m)      (m)
#define PLL_TIMES(n)       ((n) << 6) /* of the core: half of it */
#define PLL_USB_DIVIDE(q)  ((q) << 24)
#define CFGR_APB1_BY_4     (5u << 10)
#define CFGR_APB2_BY_2     (4u << 13)
#define CFGR_PLL           2u
#define CFGR_RUNS_FROM     (3u << 2)
#define CFGR_RUNS_FROM_PLL (2u << 2)
#define ACR_5_WAIT_STATES  0x705u /* with prefetch and both caches */
#define AHB1ENR_GPIOA      (1u << 0)
#define APB1ENR_TIM2       (1u << 0)
#define APB1ENR_TIM5       (1u << 3)
#define APB2ENR_USART1     (1u << 4)
#define APB2ENR_SYSCFG     (1u << 14)

/* ---- GPIO ---- */
#define GPIOA_MODER       REGISTER(0x40020000u)
#define GPIOA_PUPDR       REGISTER(0x4002000Cu)
#define GPIOA_AFRH        REGISTER(0x40020024u)
#define GPIOA_IDR_ADDRESS 0x40020010u
#define MODER_MASK(pin)   (3u << (2u * (pin)))
#define MODER_AF(pin)     (2u << (2u * (pin)))
#define PUPDR_DOWN(pin)   (2u << (2u * (pin)))
#define AFRH_USART(pin)   (7u << (4u * ((pin) - 8u)))

/* ---- edges ---- */
#define SYSCFG_EXTICR1 REGISTER(0x40013808u) /* lines 0 … 3, four bits each; 0 is port A */
#define EXTI_IMR       REGISTER(0x40013C00u)
#define EXTI_RTSR      REGISTER(0x40013C08u)
#define EXTI_FTSR      REGISTER(0x40013C0Cu)
#define EXTI_PR        REGISTER(0x40013C14u)

/* ---- timers; 2 and 5 have 32 bits ---- */
#define TIM2         0x40000000u
#define TIM4         0x40000800u
#define TIM5         0x40000C00u
#define TIM_CR1(tim) REGISTER((tim) + 0x00u)
#define TIM_EGR(tim) REGISTER((tim) + 0x14u)
#define TIM_CNT(tim) REGISTER((tim) + 0x24u)
#define TIM_PSC(tim) REGISTER((tim) + 0x28u)
#define TIM_ARR(tim) REGISTER((tim) + 0x2Cu)
#define CR1_RUN      1u
#define EGR_UPDATE   1u /* makes the prescaler valid, and the count 0 */

/* ---- USARTs ---- */
#define USART1           0x40011000u
#define USART3           0x40004800u
#define USART_SR(usart)  REGISTER((usart) + 0x00u)
#define USART_DR(usart)  REGISTER((usart) + 0x04u)
#define USART_BRR(usart) REGISTER((usart) + 0x08u)
#define USART_CR1(usart) REGISTER((usart) + 0x0Cu)
#define SR_RECEIVED      (1u << 5)
#define SR_SENT          (1u << 6)
#define CR1_ENABLE       0x200Cu /* both ways */
#define CR1_SENT_IRQ     (1u << 6)
#define CR1_EMPTY_IRQ    (1u << 7)

#define IRQ_EXTI0  6u
#define IRQ_USART1 37u
#define IRQ_USART6 71u

#endif
