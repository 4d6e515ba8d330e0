/* Where a sketch is: the program counter, and behind it what on the stack looks like a return address. */
#ifndef STACK_H
#define STACK_H

#define STACK_BYTES 200
#define CALLS 24

/* Whether the instruction before a flash address is one of those that call. */
static int is_called(uint32_t to)
{
    if (to < 4 || to > avr->flashend || to & 1)
        return 0;
    unsigned word = avr->flash[to - 2] | avr->flash[to - 1] << 8;
    unsigned before = avr->flash[to - 4] | avr->flash[to - 3] << 8;
    int relative = (word & 0xF000) == 0xD000, indirect = word == 0x9509 || word == 0x9519;
    return relative || indirect || (before & 0xFE0E) == 0x940E;
}

/* End the run. The places behind the text begin with the innermost. */
static void end_here(const char *text)
{
    char whole[700];
    int at = snprintf(whole, sizeof whole, "%s [at 0x%x", text, avr->pc);
    int bytes = avr->address_size, calls = 0;
    uint32_t last = (uint32_t)avr->ramend + 1, from = (uint32_t)_avr_sp_get(avr) + 1;
    for (uint32_t each = from; each + bytes <= last && each < from + STACK_BYTES && calls < CALLS; each++) {
        uint32_t to = 0;
        for (int byte = 0; byte < bytes; byte++)
            to = to << 8 | avr->data[each + byte];
        to *= 2;
        if (is_called(to) && ++calls)
            at += snprintf(whole + at, sizeof whole - at, " 0x%x", to - 1);
    }
    snprintf(whole + at, sizeof whole - at, "]");
    end(whole);
}

/* Firmware that is built here reports a pin that the board has not, before the core takes what lies
 * behind its tables for the pin's registers. */
#define NO_PIN 0xC7 /* a register that neither microcontroller has: see avr/pins.c */

static void no_pin(avr_t *of, avr_io_addr_t address, uint8_t pin, void *unused)
{
    char text[100];
    int mega = ports[0] == 'E';
    (void)of, (void)address, (void)unused;
    snprintf(text, sizeof text, "it uses pin %d: the %s has 0 to %d", pin, mega ? "Mega" : "Uno", mega ? 69 : 19);
    end_here(text);
}

#endif
