/*
 * What every Cortex-M has: registers of SysTick and of the interrupt controller. Names and
 * addresses as in the architecture's manual.
 */
#ifndef ARM_CORTEX_M_H
#define ARM_CORTEX_M_H

#include <stdbool.h>
#include <stdint.h>

#define REGISTER(address) (*(volatile uint32_t *)(address))

#define SYST_CSR       REGISTER(0xE000E010u)
#define SYST_RVR       REGISTER(0xE000E014u)
#define SYST_CVR       REGISTER(0xE000E018u)
#define SYST_RUN       7u /* core clock, interrupt, enable */
#define NVIC_ISER(irq) REGISTER(0xE000E100u + 4u * ((irq) / 32u))
#define NVIC_ICER(irq) REGISTER(0xE000E180u + 4u * ((irq) / 32u))
#define NVIC_ISPR(irq) REGISTER(0xE000E200u + 4u * ((irq) / 32u))
#define NVIC_ICPR(irq) REGISTER(0xE000E280u + 4u * ((irq) / 32u))
#define NVIC_IPR(irq)  REGISTER(0xE000E400u + 4u * ((irq) / 4u))
#define NVIC_BIT(irq)  (1u << ((irq) % 32u))
#define SCB_ICSR       REGISTER(0xE000ED04u)
#define SCB_VTOR       REGISTER(0xE000ED08u)
#define SCB_SHPR3      REGISTER(0xE000ED20u) /* SysTick's priority is in its upper byte */
#define ICSR_PENDSTSET (1u << 26)

/* The upper two bits of eight: those every core has. */
#define PRIORITY_SHIFT 6u

/* What waits for what. SysTick has the first after reset. */
typedef enum {
    PRIORITY_EDGE = 0,
    PRIORITY_AXIS = 1,
    PRIORITY_SCAN = 2,
    PRIORITY_UART = 3
} cortex_m_priority_t;

/* Let an interrupt come, one that was pending before not. Task. */
void cortex_m_enable_irq(uint32_t irq, cortex_m_priority_t priority);

/* Let an interrupt come that has been enabled, or hold it back: it stays pending. Task. */
void cortex_m_let_irq(uint32_t irq, bool may_come);

#endif
