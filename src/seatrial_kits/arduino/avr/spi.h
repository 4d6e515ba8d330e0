/* Parts at the SPI and at pins. A byte goes out when it is written to SPDR, and the part's has come then. */
#ifndef SPI_H
#define SPI_H

static avr_irq_t *spi_input;
static int part_drives; /* a level comes from a part, and is not the sketch's */
static uint8_t part_levels[PINS], part_watched[PINS];

static uint64_t part_call(uint8_t call, part *one, uint16_t value)
{
    link_event event = {call, (uint8_t)(one - parts), value, ticks()};
    uint32_t count = one->sent_length;
    one->sent_length = 0;
    return link_call(event, one->sent, count);
}

static void spi(avr_irq_t *irq, uint32_t value, void *unused)
{
    (void)irq, (void)unused;
    avr_raise_irq(spi_input, part_transfer((uint8_t)value));
}

static void connect_spi(void)
{
    avr_irq_t *all = avr_io_getirq(avr, AVR_IOCTL_SPI_GETIRQ(0), 0);
    if (!all)
        return;
    spi_input = all + SPI_IRQ_INPUT;
    avr_irq_register_notify(all + SPI_IRQ_OUTPUT, spi, 0);
}

/* ------------------------------------------------------------------ pins */

static void part_pin(avr_irq_t *irq, uint32_t value, void *which)
{
    uint8_t pin = *(uint8_t *)which, level = value != 0;
    (void)irq;
    if (part_levels[pin] == level)
        return;
    part_levels[pin] = level;
    if (!part_drives)
        part_edge(pin, level);
}

static void watch_part(uint8_t place)
{
    if (place >= PINS || !part_is_at(place) || part_watched[place])
        return;
    part_watched[place] = 1;
    avr_irq_register_notify(pin_irq(place), part_pin, &numbers[place]);
}

static avr_cycle_count_t drive_due(avr_t *of, avr_cycle_count_t cycle, void *unused)
{
    (void)of, (void)cycle, (void)unused;
    while (drive_next() <= ticks()) {
        drive_at one = drive_take();
        part_drives = 1;
        pin_put(one.pin, one.level != 0); /* left alone, a bus is pulled up */
        part_drives = 0;
    }
    return drive_count ? cycle_of((double)drive_next()) : 0;
}

static void restart_drives(void)
{
    avr_cycle_timer_cancel(avr, drive_due, 0);
    if (drive_count)
        later((double)drive_next(), drive_due, 0);
}

#endif
