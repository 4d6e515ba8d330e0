/* The EEPROM: given at the start, and each byte that changes is reported at the end of a step. */
#ifndef MEMORY_H
#define MEMORY_H

#define EEPROM_MOST 4096

static uint8_t memory[EEPROM_MOST];
static uint32_t memory_size;

static void memory_copy(uint8_t *to)
{
    avr_eeprom_desc_t all = {to, 0, memory_size};
    avr_ioctl(avr, AVR_IOCTL_EEPROM_GET, &all);
}

/* A write lasts 3.4 ms, while EEPE is set (ATmega2560 data sheet, 8.6.3): simavr clears it at once. Comes
 * after its own handler. */
#define EECR 0x3F
#define WRITE_TICKS (0.0034 * CLOCK)
enum { EEPE_BIT = 0x02, EEMPE_BIT = 0x04 };

static avr_cycle_count_t memory_written(avr_t *of, avr_cycle_count_t cycle, void *unused)
{
    (void)cycle, (void)unused;
    of->data[EECR] &= (uint8_t)~EEPE_BIT;
    return 0;
}

static void memory_controlled(avr_t *of, avr_io_addr_t address, uint8_t value, void *unused)
{
    static uint8_t before;
    (void)unused;
    if (value & EEPE_BIT && before & EEMPE_BIT) {
        of->data[address] |= EEPE_BIT;
        later((double)ticks() + WRITE_TICKS, memory_written, 0);
    }
    before = value;
}

/* As it is before the program runs: erased, or what the firmware brings. */
static void memory_begin(void)
{
    memory_size = avr->e2end + 1 < EEPROM_MOST ? (uint32_t)avr->e2end + 1 : EEPROM_MOST;
    memory_copy(memory);
    avr_register_io_write(avr, EECR, memory_controlled, 0);
}

static void memory_preload(uint16_t at, uint8_t value)
{
    avr_eeprom_desc_t one = {&value, at, 1};
    if (at >= memory_size)
        return;
    avr_ioctl(avr, AVR_IOCTL_EEPROM_SET, &one);
    memory[at] = value;
}

static void memory_tell(void)
{
    static uint8_t is[EEPROM_MOST];
    memory_copy(is);
    for (uint32_t at = 0; memcmp(is, memory, memory_size) && at < memory_size; at++) {
        if (is[at] != memory[at])
            link_put(OUT_EEPROM, is[at], (uint16_t)at, ticks());
        memory[at] = is[at];
    }
}

#endif
