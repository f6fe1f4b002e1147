/*
 * The STM32F4 port under test: the interrupt output of USART3 is wired to the trigger pin, and what
 * USART1 sends goes into a file, by qemu_suite.py; it is read there by semihosting. Time passes by
 * TIM4, which has 32 bits there.
 */
#include "contract/port_under_test.h"
#include "../board.h"
#include "../stm32f405.h"
#include "tests/wired_board.h"

const port_facts_t PORT = {
    .channels = 1u,
    .axes = 1u,
    .has_active_low = true,
    .filter_max_us = 0u,
    .filter_tried_us = 50u,
    .edge_latency_us = 5u,
    .frame_latency_us = 2000u,
    .time_error_us = 5u,
};

#define SYS_OPEN         0x01u
#define SYS_READ         0x06u
#define OPEN_BINARY      1u
#define SEMIHOSTING_CALL "bkpt 0xAB"

static const char SENT[] = "sent";

static uint32_t sent_handle;

const uint32_t WIRED_TICKS_PER_US = BOARD_TIMER_MHZ;
const uint32_t WIRED_UART_IRQ = IRQ_USART1;

static uint32_t ask_host(uint32_t operation, const uint32_t *argument)
{
    register uint32_t        r0 __asm__("r0") = operation;
    register const uint32_t *r1 __asm__("r1") = argument;
    __asm__ volatile(SEMIHOSTING_CALL : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

void wired_start(void)
{
    const uint32_t file[] = {(uint32_t)(uintptr_t)SENT, OPEN_BINARY, sizeof SENT - 1u};

    board_start_counter(TIM4, 1u, 0u);
    if (sent_handle == 0u) {
        sent_handle = ask_host(SYS_OPEN, file);
    }
}

uint32_t wired_ticks(void)
{
    return TIM_CNT(TIM4);
}

/* An empty transmitter asks for the next byte. */
void wired_set_line(bool high)
{
    USART_CR1(USART3) = high ? CR1_EMPTY_IRQ : 0u;
}

/* The answer is how many bytes were not read. */
int wired_hear(void)
{
    uint8_t        byte = 0u;
    const uint32_t place[] = {sent_handle, (uint32_t)(uintptr_t)&byte, 1u};

    return ask_host(SYS_READ, place) == 0u ? (int)byte : -1;
}
