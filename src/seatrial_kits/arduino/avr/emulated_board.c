/* A board on simavr: FD PATIENCE FIRMWARE MCU PINS, where PINS has port and bit of each, as E0,E1,... */
#include <sim_avr.h>
#include <sim_elf.h>
#include <sim_hex.h>
#include <avr_adc.h>
#include <avr_eeprom.h>
#include <avr_extint.h>
#include <avr_ioport.h>
#include <avr_spi.h>
#include <avr_timer.h>
#include <avr_twi.h>
#include <avr_uart.h>
#include <sim_io.h>
#include <sim_cycle_timers.h>

#include "link.h"
#include "drives.h"
#include "parts.h"
#include "rates.h"
#include "waves.h"

#define CLOCK 16e6
#define UARTS 4
#define PINS 70
static avr_t *avr;
static char ports[PINS], bits[PINS];
static uint8_t numbers[PINS];
static uint64_t target;

static char trouble[200]; /* what simavr said first of a crash */

static void logged(avr_t *from, const int level, const char *format, va_list values)
{
    (void)from;
    if (level == LOG_ERROR && !*trouble)
        vsnprintf(trouble, sizeof trouble, format, values);
}

static void slept(avr_t *of, avr_cycle_count_t cycles) { (void)of, (void)cycles; }

#include "ticks.h"

static void end(const char *why)
{
    link_answer(avr ? ticks() : 0, why);
    _exit(0);
}

#include "stack.h"

/* ------------------------------------------------------------------ pins */

static avr_irq_t *pin_irq(uint8_t pin)
{
    return avr_io_getirq(avr, AVR_IOCTL_IOPORT_GETIRQ(ports[pin]), bits[pin] - '0');
}

/* A level from outside, which a pull-up does not change. */
static void pin_put(uint8_t pin, int level)
{
    static uint8_t masks[128], values[128];
    uint8_t port = (uint8_t)ports[pin] & 127, bit = (uint8_t)(1 << (bits[pin] - '0'));
    masks[port] |= bit;
    values[port] = (uint8_t)(level ? values[port] | bit : values[port] & ~bit);
    avr_ioport_external_t all = {.name = port, .mask = masks[port], .value = values[port]};
    avr_ioctl(avr, AVR_IOCTL_IOPORT_SET_EXTERNAL(ports[pin]), &all);
    avr_raise_irq(pin_irq(pin), (uint32_t)level);
}

#include "lines.h"

static void turned(avr_irq_t *irq, uint32_t value, void *which)
{
    (void)irq;
    link_put(OUT_EDGE, *(uint8_t *)which, value ? 1 : 0, ticks());
}

#include "modulation.h"
#include "memory.h"
#include "hangs.h"

static void watch(uint8_t pin)
{
    watched[pin] = 1;
    shares[pin] = -1.0;
    avr_irq_register_notify(pin_irq(pin), turned, &numbers[pin]);
}

static avr_cycle_count_t wave_due(avr_t *of, avr_cycle_count_t cycle, void *unused)
{
    (void)of, (void)cycle, (void)unused;
    wave *one;
    while ((one = wave_turn(ticks(), CLOCK)))
        pin_put(one->pin, one->level);
    uint64_t next = wave_next();
    return next == NEVER ? 0 : cycle_of((double)next);
}

static void restart_waves(void)
{
    uint64_t next = wave_next();
    avr_cycle_timer_cancel(avr, wave_due, 0);
    if (next != NEVER)
        later((double)next, wave_due, 0);
}

#include "i2c.h"
#include "spi.h"
#include "adc.h"

/* ------------------------------------------------------------------ running */

static void take_input(const link_input *input)
{
    uint8_t index = input->index;
    switch (input->kind) {
    case IN_UART: queue(&lines[index % UARTS], (uint8_t)input->value, input->number); break;
    case IN_BAUD: line_at_rate(&lines[index % UARTS], input->number); break;
    case IN_RX_PIN: line_to_pin(&lines[index % UARTS], (uint8_t)input->value); break;
    case IN_TX_PIN: line_from_pin(&lines[index % UARTS], (uint8_t)input->value); break;
    case IN_VOLTS: adc_put(index, input->number); break;
    case IN_LEVEL: pin_put(index, input->number != 0.0); break;
    case IN_FRAME: wave_frame(index, input->number); break;
    case IN_FREQUENCY:
    case IN_PULSE:
        wave_set(index, input->kind == IN_PULSE, input->number, ticks());
        restart_waves();
        break;
    case IN_PART: part_add(input); watch_part(index); break;
    case IN_REGISTER: part_set(input); break;
    case IN_REGISTERS: part_store(input); break;
    case IN_REPLY: part_clear(input); break;
    case IN_DRIVE: drive_add(index % PINS, (uint8_t)input->value, (uint64_t)input->number); restart_drives(); break;
    case IN_FORGET: drive_forget(index % PINS); restart_drives(); break;
    case IN_WATCH: watch(index); break;
    case IN_EEPROM: memory_preload(input->value, (uint8_t)input->number); break;
    }
}

static int stop_set;

static avr_cycle_count_t stop(avr_t *of, avr_cycle_count_t when, void *unused)
{
    (void)of, (void)when, (void)unused;
    return stop_set = 0; /* it is there so that no run of instructions goes beyond the target */
}

static void crashed(void)
{
    char text[200];
    unsigned address;
    const char *at = strstr(trouble, "Address ");
    if (at && sscanf(at, "Address %x", &address) == 1)
        snprintf(text, sizeof text, "it %s address 0x%04x, beyond the memory",
                 strstr(trouble, "write") ? "writes to" : "reads from", address);
    else
        snprintf(text, sizeof text, "the microcontroller crashed: an instruction that is none, or the stack ran into "
                 "the data");
    end_here(text);
}

static void was_reset(avr_t *of)
{
    (void)of;
    link_put(OUT_RESET, 0, 0, ticks());
}

static int load(const char *file, const char *mcu)
{
    elf_firmware_t firmware;
    memset(&firmware, 0, sizeof firmware);
    if (strstr(file, ".hex")) {
        uint32_t size = 0, start = 0;
        uint8_t *flash = read_ihex_file(file, &size, &start);
        if (!flash)
            return 0;
        firmware.flash = flash;
        firmware.flashsize = size;
        firmware.flashbase = start;
    } else if (elf_read_firmware(file, &firmware) != 0) {
        return 0;
    }
    avr = avr_make_mcu_by_name(mcu);
    if (!avr)
        return 0;
    avr_init(avr);
    avr->log = LOG_NONE;
    avr->sleep = slept;
    firmware.frequency = (uint32_t)CLOCK;
    avr_load_firmware(avr, &firmware);
    avr->frequency = (uint32_t)CLOCK;
    avr_register_io_write(avr, CLKPR, clock_written, 0);
    avr_register_io_write(avr, NO_PIN, no_pin, 0);
    return 1;
}

int main(int count, char **arguments)
{
    if (count < 6)
        return 2;
    link_out = atoi(arguments[1]);
    link_take = take_input;
    patience = (uint64_t)(atof(arguments[2]) * CLOCK);
    avr_global_logger_set(logged);
    if (!load(arguments[3], arguments[4]))
        end("simavr cannot load the firmware for this microcontroller");
    const char *at = arguments[5];
    for (int pin = 0; pin < PINS && *at; pin++, at += at[2] ? 3 : 2) {
        ports[pin] = at[0];
        bits[pin] = at[1];
        numbers[pin] = (uint8_t)pin;
    }
    for (int uart = 0; uart < UARTS; uart++)
        connect_uart(uart);
    memory_begin();
    avr->reset = was_reset;
    hang_forget();
    connect_i2c();
    connect_spi();
    connect_adc();
    avr->run_cycle_limit = 1000;
    for (;;) {
        target = link_read();
        while (ticks() < target) {
            if (!stop_set)
                later((double)target, stop, 0);
            stop_set = 1;
            int state = avr_run(avr);
            hang_observe(state);
            if (state == cpu_Crashed)
                crashed();
            if (state == cpu_Done)
                end("the microcontroller sleeps with interrupts off: it will never wake");
        }
        tell_modulated();
        memory_tell();
        line_check();
        link_answer(target, "");
    }
}
