/*
 * Runs one suite on an AVR in simavr: avr_test_run MCU ELF
 *
 * What the program writes to GPIOR0 is printed, what it writes to GPIOR1 is the exit status. A wire
 * leads from TXD of UART 0 to its RXD, so that the suite can hear what it sends. The chip has RAM
 * up to RAM_END, more than its like in silicon: avr-gcc keeps the texts of a suite there. Exit
 * status 2: the program cannot be loaded, crashed, or did not end within 300 s of its own time.
 */
#include <avr_ioport.h>
#include <avr_uart.h>
#include <sim_avr.h>
#include <sim_elf.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CLOCK_HZ    16000000u
#define RAM_END     0x3FFFu
#define LIMIT_S     300u
#define EXIT_NO_RUN 2
#define GPIOR0      0x3Eu
#define GPIOR1      0x4Au

static int exit_status = -1;

static void on_character(avr_t *avr, avr_io_addr_t address, uint8_t value, void *context)
{
    (void)avr;
    (void)address;
    (void)context;
    putchar(value);
}

static void on_end(avr_t *avr, avr_io_addr_t address, uint8_t value, void *context)
{
    (void)avr;
    (void)address;
    (void)context;
    exit_status = value;
}

static avr_t *load(const char *mcu, const char *path)
{
    elf_firmware_t firmware;
    memset(&firmware, 0, sizeof firmware);
    if (elf_read_firmware(path, &firmware) != 0) {
        return NULL;
    }
    avr_t *avr = avr_make_mcu_by_name(mcu);
    if (avr != NULL) {
        avr->ramend = RAM_END;
        avr_init(avr);
        firmware.frequency = CLOCK_HZ;
        avr_load_firmware(avr, &firmware);
    }
    return avr;
}

/* simavr would also copy the bytes to its own output. */
static void wire_uart(avr_t *avr)
{
    uint32_t flags = 0;
    (void)avr_ioctl(avr, AVR_IOCTL_UART_GET_FLAGS('0'), &flags);
    flags &= ~(uint32_t)AVR_UART_FLAG_STDIO;
    (void)avr_ioctl(avr, AVR_IOCTL_UART_SET_FLAGS('0'), &flags);
    avr_connect_irq(avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUTPUT),
                    avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_INPUT));
}

static int run(avr_t *avr)
{
    const avr_cycle_count_t limit = (avr_cycle_count_t)LIMIT_S * CLOCK_HZ;
    int                     state = cpu_Running;
    while (exit_status < 0 && state != cpu_Done && state != cpu_Crashed && avr->cycle < limit) {
        state = avr_run(avr);
    }
    if (exit_status < 0) {
        printf("the program %s\n", state == cpu_Crashed ? "crashed" : "did not end");
        return EXIT_NO_RUN;
    }
    return exit_status;
}

int main(int argc, char **argv)
{
    avr_t *avr = argc == 3 ? load(argv[1], argv[2]) : NULL;
    if (avr == NULL) {
        fprintf(stderr, "usage: avr_test_run MCU ELF: a chip that simavr knows and a program\n");
        return EXIT_NO_RUN;
    }
    avr_register_io_write(avr, GPIOR0, on_character, NULL);
    avr_register_io_write(avr, GPIOR1, on_end, NULL);
    wire_uart(avr);
    return run(avr);
}
