/*
 * What every RISC-V controller of this kind has: the machine mode's registers, the timer and
 * software interrupts of CLINT, the interrupt controller PLIC. Names and addresses as in the
 * specifications; of hart 0, the only one that runs.
 */
#ifndef RISCV_RISCV_H
#define RISCV_RISCV_H

#include <stdint.h>

#define REGISTER(address) (*(volatile uint32_t *)(address))

#define CLINT_MSIP        REGISTER(0x02000000u)
#define CLINT_MTIMECMP    REGISTER(0x02004000u)
#define CLINT_MTIMECMP_HI REGISTER(0x02004004u)
#define CLINT_MTIME       REGISTER(0x0200BFF8u)
#define CLINT_MTIME_HI    REGISTER(0x0200BFFCu)

#define PLIC_PRIORITY(irq) REGISTER(0x0C000000u + 4u * (irq))
#define PLIC_ENABLE(irq)   REGISTER(0x0C002000u + 4u * ((irq) / 32u))
#define PLIC_THRESHOLD     REGISTER(0x0C200000u)
#define PLIC_CLAIM         REGISTER(0x0C200004u)
#define PLIC_BIT(irq)      (1u << ((irq) % 32u))

#define MSTATUS_MIE  (1u << 3)
#define MIE_SOFTWARE (1u << 3)
#define MIE_TIMER    (1u << 7)
#define MIE_EXTERNAL (1u << 11)

#define CSR_READ(name)                                      \
    __extension__({                                         \
        uint32_t value_;                                    \
        __asm__ volatile("csrr %0, " #name : "=r"(value_)); \
        value_;                                             \
    })
#define CSR_WRITE(name, value) __asm__ volatile("csrw " #name ", %0" : : "r"(value) : "memory")
#define CSR_SET(name, bits)    __asm__ volatile("csrs " #name ", %0" : : "r"(bits) : "memory")
#define CSR_CLEAR(name, bits)  __asm__ volatile("csrc " #name ", %0" : : "r"(bits) : "memory")

/* What waits for what, of the PLIC's; a scan, of CLINT's timer, lets in what is above the UART. */
typedef enum { PRIORITY_UART = 1, PRIORITY_EDGE = 2 } riscv_priority_t;

/* Cycles of the core since reset; 64 bits in one piece. Any context. */
uint64_t riscv_cycles(void);

/* Let an interrupt of the PLIC come. Task. */
void riscv_enable_irq(uint32_t irq, riscv_priority_t priority);

/* What a handler that lets edges in has to put back. */
typedef struct {
    uint32_t mepc;
    uint32_t mstatus;
    uint32_t mie;
} riscv_opened_t;

/* From now on only what is more urgent than the UART interrupts this handler. Interrupt. */
static inline riscv_opened_t riscv_open(void)
{
    riscv_opened_t saved = {CSR_READ(mepc), CSR_READ(mstatus), CSR_READ(mie)};
    PLIC_THRESHOLD = PRIORITY_UART;
    CSR_CLEAR(mie, MIE_TIMER);
    CSR_SET(mstatus, MSTATUS_MIE);
    return saved;
}

/* As before riscv_open(). Interrupt. */
static inline void riscv_close(riscv_opened_t saved)
{
    CSR_CLEAR(mstatus, MSTATUS_MIE);
    CSR_WRITE(mie, saved.mie);
    CSR_WRITE(mstatus, saved.mstatus);
    CSR_WRITE(mepc, saved.mepc);
    PLIC_THRESHOLD = 0u;
}

/*
 * The vectors, of each board's startup.c; `interrupt` has the compiler save what it uses. Those of
 * exceptions and of what is never switched on end in stay().
 */
void software_trap(void);
void timer_trap(void);
void external_trap(void);

#endif
