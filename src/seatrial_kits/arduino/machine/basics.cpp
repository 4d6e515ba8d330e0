/* What the API has alike on every board; see basics.h. */
#include "Arduino.h"
#include "machine.h"

/* ------------------------------------------------------------------ pins */

sketch_ulong pulseIn(uint8_t pin, uint8_t level, sketch_ulong timeout)
{
    constexpr uint64_t US = 16;
    uint64_t latest = machine::now + timeout * US;
    auto wait = [&](bool until) {
        while (machine::level(pin) != until && machine::now < latest)
            machine::pass_until(latest, true);
    };
    wait(!level);
    wait(level);
    uint64_t begin = machine::now;
    wait(!level);
    return machine::now >= latest ? 0 : (sketch_ulong)((machine::now - begin) / US);
}

sketch_ulong pulseInLong(uint8_t pin, uint8_t level, sketch_ulong timeout) { return pulseIn(pin, level, timeout); }

void shiftOut(uint8_t data, uint8_t clock, uint8_t order, uint8_t value)
{
    for (int i = 0; i < 8; i++) {
        digitalWrite(data, value >> (order == LSBFIRST ? i : 7 - i) & 1);
        digitalWrite(clock, HIGH);
        digitalWrite(clock, LOW);
    }
}

uint8_t shiftIn(uint8_t data, uint8_t clock, uint8_t order)
{
    uint8_t value = 0;
    for (int i = 0; i < 8; i++) {
        digitalWrite(clock, HIGH);
        value |= (uint8_t)(digitalRead(data) << (order == LSBFIRST ? i : 7 - i));
        digitalWrite(clock, LOW);
    }
    return value;
}

/* ------------------------------------------------------------------ strings */

size_t sketch_strlcpy(char *to, const char *from, size_t size)
{
    size_t length = strlen(from), n = length < size ? length : size - 1;
    if (size) {
        memcpy(to, from, n);
        to[n] = 0;
    }
    return length;
}

size_t sketch_strlcat(char *to, const char *from, size_t size)
{
    size_t before = strnlen(to, size);
    return before + (before < size ? sketch_strlcpy(to + before, from, size - before) : strlen(from));
}

char *strupr(char *text)
{
    for (char *c = text; *c; c++)
        *c = (char)toupper((unsigned char)*c);
    return text;
}

char *strlwr(char *text)
{
    for (char *c = text; *c; c++)
        *c = (char)tolower((unsigned char)*c);
    return text;
}
