#include "board.h"

#include "drivers.h"
#include "stm32f405.h"

#define TXD 9u
#define RXD 10u

/* 160 MHz out of the PLL, in the order of the manual: nothing runs from it before it is locked. */
static void start_pll(void)
{
    RCC_CR |= CR_HSE_ON;
    while ((RCC_CR & CR_HSE_READY) == 0u) {
    }
    RCC_PLLCFGR = PLL_OF_HSE | PLL_DIVIDE(4u) | PLL_TIMES(160u) | PLL_USB_DIVIDE(7u);
    RCC_CR |= CR_PLL_ON;
    FLASH_ACR = ACR_5_WAIT_STATES;
    RCC_CFGR = CFGR_APB1_BY_4 | CFGR_APB2_BY_2;
    while ((RCC_CR & CR_PLL_READY) == 0u) {
    }
    RCC_CFGR = CFGR_APB1_BY_4 | CFGR_APB2_BY_2 | CFGR_PLL;
    while ((RCC_CFGR & CFGR_RUNS_FROM) != CFGR_RUNS_FROM_PLL) {
    }
}

static void start_peripherals(void)
{
    RCC_AHB1ENR |= AHB1ENR_GPIOA;
    RCC_APB1ENR |= APB1ENR_TIM2 | APB1ENR_TIM5;
    RCC_APB2ENR |= APB2ENR_USART1 | APB2ENR_SYSCFG;
    (void)RCC_APB2ENR; /* the clocks take effect some cycles later */
    GPIOA_MODER =
        (GPIOA_MODER & ~(MODER_MASK(TXD) | MODER_MASK(RXD))) | MODER_AF(TXD) | MODER_AF(RXD);
    GPIOA_AFRH |= AFRH_USART(TXD) | AFRH_USART(RXD);
}

void board_start(void)
{
    if (BOARD_SETS_CLOCKS) {
        start_pll();
    }
    start_peripherals();
    clock_start(0u);
    edge_start();
    axis_place(0);
    bus_start();
}

void board_start_counter(uint32_t tim, uint32_t cycles, uint32_t count)
{
    TIM_CR1(tim) = 0u;
    TIM_ARR(tim) = UINT32_MAX;
    TIM_PSC(tim) = cycles - 1u;
    TIM_EGR(tim) = EGR_UPDATE;
    TIM_CNT(tim) = count;
    TIM_CR1(tim) = CR1_RUN;
}
