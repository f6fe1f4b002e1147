/* Trains of edges: USART3's interrupt output is wired to the trigger pin by the emulator. */
#include "drivers.h"
#include "stm32f405.h"
#include "train.h"

/* An empty transmitter asks for the next byte, as soon as it may. Interrupt. */
void board_on_scan(void)
{
    if (train_edge_is_due()) {
        USART_CR1(USART3) = 0u;
        USART_CR1(USART3) = CR1_EMPTY_IRQ;
    }
    train_scan();
}

int main(void)
{
    return train_main();
}
