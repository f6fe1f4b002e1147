/*
 * The rig of the AVR boards: runs a program in simavr and plays a list of stimuli to it.
 *
 *   simavr_rig FIRMWARE.elf [PIN] <STIMULI >EVENTS
 *
 * PIN is that of the trigger line, B0 unless it is named.
 *
 * A stimulus is a line "CYCLE KIND VALUE", cycles rising: "e 1" and "e 0" raise and lower the
 * trigger line, "p 0" and "p 1" raise a pulse input and "l 0" and "l 1" lower it, "u 115" sends a
 * byte to the UART, "q 0" ends the run. What comes back, one line each:
 *
 *   edge CYCLE LEVEL PULSES      the line was driven; pulses forward less backward on the step pin
 *   around BEFORE AFTER          after an edge: the pulses on the step pin before it and next
 *   tick CYCLE                   a compare of Timer1, up to the first edge
 *   pulse CYCLE CHANNEL          the edge of a pulse
 *   note CYCLE CHANNEL OVERFLOWS TIMER LOST   what the firmware has noted of it ("pulse_notes")
 *   byte CYCLE VALUE             the last bit of a byte has left the UART
 *   check CYCLE PULSES COUNTS    after a touch, interrupts on: pulses on the pin, counts of the
 *                                firmware ("axis_position", or the first of "stepper_tick"); they
 *                                have to be the same
 *   end CYCLE BUSY LOST          at the end: cycles spent in interrupts, edges that were lost
 *   body and wait                of each interrupt, see simavr_rig_interrupts.h
 *
 * simavr 1.6 omits the four cycles in which the chip enters an interrupt: they are in none of these
 * figures. It applies a stimulus at the end of the instruction that runs at its cycle; "edge" tells
 * the cycle at which it did. Its capture sees an edge at once; the chip's synchroniser takes
 * another 2 1/2 to 3 1/2 cycles, the same for each edge to within one.
 */
#include <inttypes.h>
#include <simavr/avr_ioport.h>
#include <simavr/avr_uart.h>
#include <simavr/sim_avr.h>
#include <simavr/sim_elf.h>
#include <simavr/sim_interrupts.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "simavr_rig_interrupts.h"

#define CLOCK_HZ      16000000u
#define TRIGGER_PORT  'B'
#define TRIGGER_PIN   0
#define STEP_PIN      2
#define PULSE_PIN     2 /* of channel 0; channel 1 is the trigger line's */
#define NOTE_BYTES    6u
#define NOTES         128u
#define DIRECTION_PIN 3
#define BYTE_CYCLES   640u /* ten bits at 250 kBd */
#define RAM_OFFSET    0x800000u
#define COMPARE       11u
#define OVERFLOW      13u
#define EXIT_USAGE    2
#define EXIT_STOPPED  3

static avr_t   *avr;
static uint32_t position_address;
static uint32_t lost_address;
static uint32_t notes_address;
static uint32_t noted_address;
static uint8_t  noted;
static bool     is_direction_back;
static int32_t  pulses;
static uint64_t pulse_cycle;
static unsigned open_edges; /* no pulse has come after them yet */
static bool     has_edge;
static char     trigger_port = TRIGGER_PORT;
static int      trigger_pin = TRIGGER_PIN;
static bool     wants_check;

/* ---- what the chip does ---- */

static void on_step(avr_irq_t *irq, uint32_t value, void *param)
{
    (void)param;
    if (value == 0u || irq->value != 0u) {
        return;
    }
    pulses += is_direction_back ? -1 : 1;
    for (; open_edges != 0u; --open_edges) {
        printf("around %" PRIu64 " %" PRIu64 "\n", pulse_cycle, avr->cycle);
    }
    pulse_cycle = avr->cycle;
}

static void on_direction(avr_irq_t *irq, uint32_t value, void *param)
{
    (void)irq;
    (void)param;
    is_direction_back = value != 0u;
}

static void on_byte(avr_irq_t *irq, uint32_t value, void *param)
{
    (void)irq;
    (void)param;
    printf("byte %" PRIu64 " %" PRIu32 "\n", avr->cycle + BYTE_CYCLES, value);
}

static void on_overflow(avr_irq_t *irq, uint32_t value, void *param)
{
    (void)irq;
    (void)param;
    if (value != 0u) {
        printf("overflow %" PRIu64 "\n", avr->cycle);
    }
}

static void on_compare(avr_irq_t *irq, uint32_t value, void *param)
{
    (void)irq;
    (void)param;
    if (value != 0u && !has_edge) {
        printf("tick %" PRIu64 "\n", avr->cycle);
    }
}

static void listen(void)
{
    uint32_t flags = 0u;
    avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_IOPORT_GETIRQ('D'), STEP_PIN), on_step,
                            NULL);
    avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_IOPORT_GETIRQ('D'), DIRECTION_PIN),
                            on_direction, NULL);
    avr_ioctl(avr, AVR_IOCTL_UART_GET_FLAGS('0'), &flags);
    flags &= (uint32_t)~(AVR_UART_FLAG_STDIO | AVR_UART_FLAG_POOL_SLEEP);
    avr_ioctl(avr, AVR_IOCTL_UART_SET_FLAGS('0'), &flags);
    avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUTPUT),
                            on_byte, NULL);
    avr_irq_register_notify(avr_get_interrupt_irq(avr, OVERFLOW) + AVR_INT_IRQ_PENDING, on_overflow,
                            NULL);
    avr_irq_register_notify(avr_get_interrupt_irq(avr, COMPARE) + AVR_INT_IRQ_PENDING, on_compare,
                            NULL);
    interrupts_listen(avr);
}

/* ---- the stimuli ---- */

static avr_irq_t *trigger_line(void)
{
    return avr_io_getirq(avr, (uint32_t)AVR_IOCTL_IOPORT_GETIRQ(trigger_port), trigger_pin);
}

static void drive(uint32_t level)
{
    printf("edge %" PRIu64 " %" PRIu32 " %" PRId32 "\n", avr->cycle, level, pulses);
    if (level != 0u) {
        interrupts_await_edge();
        ++open_edges;
        has_edge = true;
    } else {
        wants_check = true;
    }
    avr_raise_irq(trigger_line(), level);
}

static void drive_pulse(uint32_t channel, uint32_t level)
{
    avr_irq_t *line = channel == 0u ? avr_io_getirq(avr, AVR_IOCTL_IOPORT_GETIRQ('D'), PULSE_PIN)
                                    : trigger_line();
    if (level != 0u) {
        printf("pulse %" PRIu64 " %" PRIu32 "\n", avr->cycle, channel);
    }
    avr_raise_irq(line, level);
}

/* Reads the next stimulus and asks to be called at its cycle, or ends the run. */
static avr_cycle_count_t play(avr_t *of, avr_cycle_count_t when, void *param)
{
    static char     kind = '\0';
    static uint32_t value;
    static uint64_t cycle;
    (void)when;
    (void)param;
    do {
        if (kind == 'e') {
            drive(value);
        } else if (kind == 'p' || kind == 'l') {
            drive_pulse(value, kind == 'p');
        } else if (kind == 'u') {
            avr_raise_irq(avr_io_getirq(of, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_INPUT), value);
        } else if (kind == 'q') {
            of->state = cpu_Done;
            return 0u;
        }
        if (scanf("%" SCNu64 " %c %" SCNu32, &cycle, &kind, &value) != 3) {
            fprintf(stderr, "simavr_rig: expected lines CYCLE e|p|l|u|q VALUE, and q at the end\n");
            exit(EXIT_USAGE);
        }
    } while (cycle <= of->cycle);
    return cycle;
}

static uint32_t read_ram(uint32_t address, unsigned bytes)
{
    uint32_t value = 0u;
    for (unsigned i = 0u; i < bytes; ++i) {
        value |= (uint32_t)avr->data[address + i] << 8u * i;
    }
    return value;
}

/* The firmware's counter, at an instant when no interrupt is half through with it. */
static void check_position(void)
{
    if (position_address == 0u || !wants_check || interrupts_are_running() ||
        avr->sreg[S_I] == 0u) {
        return;
    }
    printf("check %" PRIu64 " %" PRId32 " %" PRId32 "\n", avr->cycle, pulses,
           (int32_t)read_ram(position_address, sizeof(int32_t)));
    wants_check = false;
}

/* What the firmware has noted since the last look: its count goes up when a note is whole. */
static void tell_notes(void)
{
    while (noted_address != 0u && noted != avr->data[noted_address]) {
        uint32_t note = notes_address + NOTE_BYTES * (noted % NOTES);
        printf("note %" PRIu64 " %u %" PRIu32 " %" PRIu32 " %u\n", avr->cycle, avr->data[note + 4u],
               read_ram(note + 2u, 2u), read_ram(note, 2u), avr->data[note + 5u]);
        ++noted;
    }
}

/* ---- start ---- */

static uint32_t address_of(const elf_firmware_t *firmware, const char *name)
{
    size_t length = strlen(name);
    for (uint32_t i = 0u; i < firmware->symbolcount; ++i) {
        const char *symbol = firmware->symbol[i]->symbol;
        if (strncmp(symbol, name, length) == 0 &&
            (symbol[length] == '\0' || symbol[length] == '.')) {
            return firmware->symbol[i]->addr - RAM_OFFSET;
        }
    }
    return 0u;
}

static bool load(const char *path)
{
    elf_firmware_t firmware;
    memset(&firmware, 0, sizeof firmware);
    if (elf_read_firmware(path, &firmware) != 0) {
        fprintf(stderr, "simavr_rig: %s: no AVR program\n", path);
        return false;
    }
    position_address = address_of(&firmware, "axis_position");
    if (position_address == 0u) {
        position_address = address_of(&firmware, "stepper_tick");
    }
    lost_address = address_of(&firmware, "edge_line_lost");
    notes_address = address_of(&firmware, "pulse_notes");
    noted_address = address_of(&firmware, "pulse_noted");
    if (notes_address != 0u) {
        lost_address = address_of(&firmware, "transmission_unsent");
    }
    avr = avr_make_mcu_by_name("atmega328p");
    if (avr == NULL || lost_address == 0u || (position_address == 0u && notes_address == 0u)) {
        fprintf(stderr, "simavr_rig: %s: no axis_position, stepper_tick or pulse_notes found\n",
                path);
        return false;
    }
    avr_init(avr);
    avr->frequency = CLOCK_HZ;
    avr_load_firmware(avr, &firmware);
    return true;
}

int main(int argc, char **argv)
{
    bool names_pin = argc == 3 && strlen(argv[2]) == 2u;
    if (argc != 2 && !names_pin) {
        fprintf(stderr, "usage: simavr_rig FIRMWARE.elf [PIN] <STIMULI >EVENTS\n");
        return EXIT_USAGE;
    }
    if (names_pin) {
        trigger_port = argv[2][0];
        trigger_pin = argv[2][1] - '0';
    }
    if (!load(argv[1])) {
        return EXIT_USAGE;
    }
    listen();
    avr_cycle_timer_register(avr, 1u, play, NULL);
    int state = cpu_Running;
    while (state != cpu_Done && state != cpu_Crashed) {
        state = avr_run(avr);
        check_position();
        tell_notes();
    }
    printf("end %" PRIu64 " %" PRIu64 " %" PRIu32 "\n", avr->cycle, interrupts_busy_cycles(),
           read_ram(lost_address, sizeof(uint16_t)));
    interrupts_print();
    return state == cpu_Done ? EXIT_SUCCESS : EXIT_STOPPED;
}
