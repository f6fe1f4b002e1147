/*
 * The first instructions: hart 0 gets its stack and its vectors, all others wait for ever. The
 * table has a jump for each cause of an interrupt; its place 0 is that of all exceptions. The
 * board brings reset, stay and the traps; hal/ports/qemu has the first two.
 */
#include "riscv.h"

void vectors(void);

__attribute__((section(".vectors"), naked, used)) void vectors(void)
{
    __asm__ volatile(".option push\n"
                     ".option norvc\n"
                     "    csrr t0, mhartid\n"
                     "    bnez t0, 2f\n"
                     "    la sp, link_stack_end\n"
                     "    la t0, 3f\n"
                     "    ori t0, t0, 1\n" /* vectored */
                     "    csrw mtvec, t0\n"
                     "    csrsi mstatus, 8\n"
                     "    j reset\n"
                     "2:  wfi\n"
                     "    j 2b\n"
                     "    .balign 256\n"
                     "3:\n"
                     "    .rept 3\n"
                     "    j stay\n"
                     "    .endr\n"
                     "    j software_trap\n"
                     "    .rept 3\n"
                     "    j stay\n"
                     "    .endr\n"
                     "    j timer_trap\n"
                     "    .rept 3\n"
                     "    j stay\n"
                     "    .endr\n"
                     "    j external_trap\n"
                     ".option pop\n");
}
