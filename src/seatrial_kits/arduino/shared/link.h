/* The pipe between a simulated board and the process that steps it: records of 12 bytes, little endian.
 *
 * Request: u32 size, u64 target (cycles), records {u8 kind, u8 index, u16 value, f64 number}.
 * Answered: u32 size, u64 reached (cycles), u32 number of records, records
 * {u8 kind, u8 index, u16 value, u64 cycle}, and a text if the sketch has come to an end.
 */
#ifndef SEATRIAL_LINK_H
#define SEATRIAL_LINK_H

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define LINK_IN 0

#pragma pack(push, 1)
typedef struct {
    uint8_t kind, index;
    uint16_t value;
    double number;
} link_input;

typedef struct {
    uint8_t kind, index;
    uint16_t value;
    uint64_t cycle;
} link_event;
#pragma pack(pop)

enum {
    IN_UART = 'U',      /* byte `value` on UART `index`, not before cycle `number` */
    IN_BAUD = 'S',      /* baud rate of the line at UART `index` */
    IN_RX_PIN = 'r',    /* the line of UART `index` ends at pin `value`, not at the UART */
    IN_TX_PIN = 't',    /* and begins at pin `value` */
    IN_VOLTS = 'A',     /* at ADC channel `index` */
    IN_LEVEL = 'L',     /* at pin `index` */
    IN_FREQUENCY = 'F', /* of a square wave at pin `index`, Hz */
    IN_PULSE = 'R',     /* width of the servo pulses at pin `index`, s */
    IN_QUANTITY = 'V',  /* `index` as in parts.h */
    IN_PART = 'I',      /* I2C device of type `value` at address `index` */
    IN_EEPROM = 'E',    /* byte `number` of the EEPROM, at address `value` */
    IN_WATCH = 'W',     /* pin `index` is to be reported */
    OUT_UART = 'T',     /* byte `value` left UART `index` */
    OUT_DUTY = 'D',     /* pin `index` is modulated by hardware: high for `value` of 65535 */
    OUT_WIDTH = 'H',    /* and high for `value` microseconds at a time */
    OUT_EEPROM = 'e',   /* byte `index` is in the EEPROM at address `value` now */
    OUT_RESET = 'R',    /* the board has started again */
    OUT_EDGE = 'P',     /* pin `index` is now at level `value` */
};

static int link_out; /* not 1: what a program prints is not an answer */
static link_event *link_events;
static uint32_t link_count, link_room;

static void link_put(uint8_t kind, uint8_t index, uint16_t value, uint64_t cycle)
{
    if (link_count == link_room) {
        link_room = link_room ? 2 * link_room : 1024;
        link_events = (link_event *)realloc(link_events, link_room * sizeof(link_event));
        if (!link_events)
            _exit(4);
    }
    link_event *event = &link_events[link_count++];
    event->kind = kind;
    event->index = index;
    event->value = value;
    event->cycle = cycle;
}

static int link_read_all(void *to, size_t size)
{
    for (size_t done = 0; done < size;) {
        ssize_t n = read(LINK_IN, (char *)to + done, size - done);
        if (n <= 0)
            return 0;
        done += (size_t)n;
    }
    return 1;
}

static void link_write_all(const void *from, size_t size)
{
    for (size_t done = 0; done < size;) {
        ssize_t n = write(link_out, (const char *)from + done, size - done);
        if (n <= 0)
            _exit(0);
        done += (size_t)n;
    }
}

/* Answer with what has happened until `reached`, and, if it has come to an end, why. */
static void link_answer(uint64_t reached, const char *end)
{
    uint32_t text = (uint32_t)strlen(end);
    uint32_t bytes = link_count * (uint32_t)sizeof(link_event);
    uint32_t size = 12 + bytes + text;
    char head[16];
    memcpy(head, &size, 4);
    memcpy(head + 4, &reached, 8);
    memcpy(head + 12, &link_count, 4);
    link_write_all(head, 16);
    link_write_all(link_events, bytes);
    link_write_all(end, text);
    link_count = 0;
}

/* Wait for the next request, give each record to `take`, and return its target; the program
 * ends with the one that requests it. */
static uint64_t link_await(void (*take)(const link_input *))
{
    static char *buffer;
    static uint32_t room;
    uint32_t size;
    uint64_t target;
    if (!link_read_all(&size, 4))
        _exit(0);
    if (size > room)
        buffer = (char *)realloc(buffer, room = size);
    if (!buffer || !link_read_all(buffer, size))
        _exit(0);
    memcpy(&target, buffer, 8);
    for (uint32_t at = 8; at + sizeof(link_input) <= size; at += sizeof(link_input)) {
        link_input input;
        memcpy(&input, buffer + at, sizeof input);
        take(&input);
    }
    return target;
}

#endif
