/*
 * Plays touches to the program of the ATmega2560 port in simavr:
 *
 *   run FIRMWARE.elf PATH TOUCHES SEED
 *
 * PATH is the byte that chooses it, "s" or "p". The axis runs at one step every 200 µs; touches
 * come every 9 to 13 ms and last 4.5 ms, longer than a scan. Written are, one a line: "edge CYCLE
 * COUNTS" of each rising edge, with the steps until then; "byte VALUE" of each byte from the UART;
 * at the end "stack BYTES", the most that the stack has taken.
 */
#include <avr_ioport.h>
#include <avr_uart.h>
#include <sim_avr.h>
#include <sim_elf.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CLOCK_HZ      16000000u
#define CYCLES_PER_US (CLOCK_HZ / 1000000u)
#define STEP_CYCLES   (200u * CYCLES_PER_US)
#define PULSE_CYCLES  (5u * CYCLES_PER_US)
#define TOUCH_CYCLES  (4500u * CYCLES_PER_US)
#define REST_CYCLES   (4500u * CYCLES_PER_US)
#define SPREAD_CYCLES (4000u * CYCLES_PER_US)
#define START_CYCLES  (20000u * CYCLES_PER_US)
#define SP_LOW        0x5Du
#define SP_HIGH       0x5Eu
#define EXIT_USAGE    2

typedef struct {
    avr_t            *avr;
    avr_irq_t        *line;
    avr_irq_t        *step;
    avr_cycle_count_t next_edge;
    avr_cycle_count_t next_step;
    uint32_t          random;
    long              touches_left;
    int               counts;
    bool              is_deflected;
    bool              is_stepping;
    unsigned          lowest_stack;
} rig_t;

static void on_byte(struct avr_irq_t *irq, uint32_t value, void *context)
{
    (void)irq;
    (void)context;
    printf("byte %u\n", value & 0xFFu);
}

static avr_irq_t *pin(avr_t *avr, char port, int bit)
{
    return avr_io_getirq(avr, (uint32_t)AVR_IOCTL_IOPORT_GETIRQ(port), bit);
}

/* Numerical Recipes' generator; its high bits will do for instants. */
static uint32_t draw(rig_t *rig, uint32_t below)
{
    rig->random = rig->random * 1664525u + 1013904223u;
    return (uint32_t)((uint64_t)rig->random * below >> 32);
}

static void play_step(rig_t *rig)
{
    rig->is_stepping = !rig->is_stepping;
    avr_raise_irq(rig->step, rig->is_stepping);
    rig->counts += rig->is_stepping ? 1 : 0;
    rig->next_step += rig->is_stepping ? PULSE_CYCLES : STEP_CYCLES - PULSE_CYCLES;
}

static void play_edge(rig_t *rig)
{
    rig->is_deflected = !rig->is_deflected;
    avr_raise_irq(rig->line, rig->is_deflected);
    if (rig->is_deflected) {
        printf("edge %llu %d\n", (unsigned long long)rig->avr->cycle, rig->counts);
        rig->next_edge += TOUCH_CYCLES;
    } else {
        --rig->touches_left;
        rig->next_edge += REST_CYCLES + draw(rig, SPREAD_CYCLES);
    }
}

static void note_stack(rig_t *rig)
{
    unsigned now = rig->avr->data[SP_LOW] | (unsigned)rig->avr->data[SP_HIGH] << 8;
    if (now != 0u && now < rig->lowest_stack) {
        rig->lowest_stack = now;
    }
}

static void run(rig_t *rig)
{
    int state = cpu_Running;
    while (rig->touches_left > 0 && state != cpu_Done && state != cpu_Crashed) {
        if (rig->avr->cycle >= rig->next_step) {
            play_step(rig);
        }
        if (rig->avr->cycle >= rig->next_edge) {
            play_edge(rig);
        }
        state = avr_run(rig->avr);
        note_stack(rig);
    }
    printf("stack %u\n", rig->avr->ramend - rig->lowest_stack);
}

static avr_t *load(const char *path)
{
    elf_firmware_t firmware;
    memset(&firmware, 0, sizeof firmware);
    avr_t *avr = avr_make_mcu_by_name("atmega2560");
    if (avr == NULL || elf_read_firmware(path, &firmware) != 0) {
        return NULL;
    }
    avr_init(avr);
    firmware.frequency = CLOCK_HZ;
    avr_load_firmware(avr, &firmware);
    return avr;
}

static void listen_to_uart(avr_t *avr)
{
    uint32_t flags = 0;
    (void)avr_ioctl(avr, AVR_IOCTL_UART_GET_FLAGS('0'), &flags);
    flags &= ~(uint32_t)AVR_UART_FLAG_STDIO;
    (void)avr_ioctl(avr, AVR_IOCTL_UART_SET_FLAGS('0'), &flags);
    avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUTPUT),
                            on_byte, NULL);
}

/* The program is up before it is told its path. */
static void choose_path(avr_t *avr, char path)
{
    while (avr->cycle < START_CYCLES / 2u) {
        (void)avr_run(avr);
    }
    avr_raise_irq(avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_INPUT),
                  (unsigned char)path);
}

int main(int argc, char **argv)
{
    avr_t *avr = argc == 5 ? load(argv[1]) : NULL;
    if (avr == NULL) {
        fprintf(stderr, "usage: run FIRMWARE.elf s|p TOUCHES SEED\n");
        return EXIT_USAGE;
    }
    rig_t rig = {
        .avr = avr,
        .line = pin(avr, 'D', 4),
        .step = pin(avr, 'E', 4),
        .next_edge = START_CYCLES,
        .next_step = START_CYCLES / 2u,
        .random = (uint32_t)strtoul(argv[4], NULL, 10),
        .touches_left = strtol(argv[3], NULL, 10),
        .lowest_stack = avr->ramend,
    };
    listen_to_uart(avr);
    avr_raise_irq(pin(avr, 'E', 5), 1);
    choose_path(avr, argv[2][0]);
    run(&rig);
    return 0;
}
