/* The program of these boards: their wiring, and nothing else. */
#include "drivers.h"
#include "wiring.h"

/* Interrupt. */
void board_on_scan(void)
{
    wiring_scan();
}

int main(void)
{
    if (!wiring_start()) {
        return 1; /* the tables of the wiring ask for what the board does not have */
    }
    for (;;) {
        wiring_round();
    }
}
