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

/* As it is before the program runs: erased, or what the firmware brings. */
static void memory_begin(void)
{
    memory_size = avr->e2end + 1 < EEPROM_MOST ? (uint32_t)avr->e2end + 1 : EEPROM_MOST;
    memory_copy(memory);
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
