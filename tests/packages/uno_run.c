/*
 * Runs a sketch on an ATmega328P in simavr: uno_run ELF. Pin 2 of the Uno is touched at 100,000 and
 * at 150,300 µs, each time with a bounce 100 µs later, for 20 ms; what the sketch prints goes to
 * the standard output. Exit status 2: the program cannot be loaded or crashed.
 */
#include <avr_ioport.h>
#include <avr_uart.h>
#include <sim_avr.h>
#include <sim_elf.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#define CLOCK_HZ      16000000u
#define CYCLES_PER_US 16u
#define END_US        250000u
#define EXIT_NO_RUN   2

typedef struct {
    uint32_t at_us;
    uint32_t level;
} edge_t;

static const edge_t EDGES[] = {
    {0u, 1u},      {100000u, 0u}, {100050u, 1u}, {100100u, 0u}, {120000u, 1u},
    {150300u, 0u}, {150350u, 1u}, {150400u, 0u}, {170300u, 1u}, {END_US, 1u},
};

static avr_t *load(const char *path)
{
    elf_firmware_t firmware;
    memset(&firmware, 0, sizeof firmware);
    avr_t *avr =
        elf_read_firmware(path, &firmware) == 0 ? avr_make_mcu_by_name("atmega328p") : NULL;
    if (avr != NULL) {
        avr_init(avr);
        firmware.frequency = CLOCK_HZ;
        avr_load_firmware(avr, &firmware);
    }
    return avr;
}

static void on_character(struct avr_irq_t *irq, uint32_t value, void *context)
{
    (void)irq;
    (void)context;
    putchar((int)value);
}

/* simavr would colour and cut what it shows by itself. */
static void show_uart(avr_t *avr)
{
    uint32_t flags = 0;
    (void)avr_ioctl(avr, AVR_IOCTL_UART_GET_FLAGS('0'), &flags);
    flags &= ~(uint32_t)AVR_UART_FLAG_STDIO;
    (void)avr_ioctl(avr, AVR_IOCTL_UART_SET_FLAGS('0'), &flags);
    avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUTPUT),
                            on_character, NULL);
}

int main(int argc, char **argv)
{
    avr_t *avr = argc == 2 ? load(argv[1]) : NULL;
    if (avr == NULL) {
        fprintf(stderr, "usage: uno_run ELF\n");
        return EXIT_NO_RUN;
    }
    show_uart(avr);
    avr_irq_t *pin = avr_io_getirq(avr, AVR_IOCTL_IOPORT_GETIRQ('D'), 2);
    for (size_t i = 0u; i < sizeof EDGES / sizeof EDGES[0]; ++i) {
        while (avr->cycle < (avr_cycle_count_t)EDGES[i].at_us * CYCLES_PER_US) {
            if (avr_run(avr) == cpu_Crashed) {
                return EXIT_NO_RUN;
            }
        }
        avr_raise_irq(pin, EDGES[i].level);
    }
    return 0;
}
