/* The pipe between a simulated board and the process that steps it: records of 12 bytes, little endian.
 *
 * Request: u32 size, u64 target (cycles), records {u8 kind, u8 index, u16 value, f64 number}.
 * Answered: u32 size, u64 reached (cycles), u32 number of records, records
 * {u8 kind, u8 index, u16 value, u64 cycle}, and a text if the sketch has come to an end.
 *
 * On the way a board may call: u32 LINK_CALL, a record {u8 call, u8 part, u16 value, u64 cycle}, u32 number of
 * bytes, the bytes. Answered: u32 size, u64 result, records as of a request.
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
    IN_FRAME = 'Q',     /* how long from one of these to the next, s; 20 ms if it is not given */
    IN_PULSE = 'R',     /* width of the servo pulses at pin `index`, s */
    IN_PART = 'I',      /* a part of kind `value` at address or pin `index`: see parts.h, as of the next three */
    IN_REGISTER = 'g',
    IN_REGISTERS = 'G',
    IN_REPLY = 'y',
    IN_DRIVE = 'd',     /* a part drives pin `index` at cycle `number` to level `value`; 2: it leaves it */
    IN_FORGET = 'f',    /* what parts were to drive at pin `index` is off */
    IN_EEPROM = 'E',    /* byte `number` of the EEPROM, at address `value` */
    IN_MESSAGE = 'M',   /* a message of `value` bytes comes on channel `index`: see machine/messages.h */
    IN_MORE = 'm',      /* `value` bytes more of it, in `number` */
    IN_WATCH = 'W',     /* pin `index` is to be reported */
    OUT_UART = 'T',     /* byte `value` left UART `index` */
    OUT_DUTY = 'D',     /* pin `index` is modulated by hardware: high for `value` of 65535 */
    OUT_WIDTH = 'H',    /* and high for `value` microseconds at a time */
    OUT_EEPROM = 'e',   /* byte `index` is in the EEPROM at address `value` now */
    OUT_MESSAGE = 'M',  /* as IN_MESSAGE */
    OUT_MORE = 'm',     /* two bytes more of it, in `value`, the first one low */
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

static void (*link_take)(const link_input *);

/* Read a request or the answer of a call, give each record to `link_take`, and return its number. */
static uint64_t link_read(void)
{
    char head[12], *all;
    uint32_t size;
    uint64_t number;
    if (!link_read_all(head, 12))
        _exit(0);
    memcpy(&size, head, 4);
    memcpy(&number, head + 4, 8);
    size -= 8;
    if (!size)
        return number;
    all = (char *)malloc(size); /* a record may lead to a call, and that comes here */
    if (!all || !link_read_all(all, size))
        _exit(0);
    for (uint32_t at = 0; at + sizeof(link_input) <= size; at += sizeof(link_input)) {
        link_input input;
        memcpy(&input, all + at, sizeof input);
        link_take(&input);
    }
    free(all);
    return number;
}

#define LINK_CALL 0xFFFFFFFFu

static uint64_t link_call(link_event call, const uint8_t *bytes, uint32_t count)
{
    uint32_t mark = LINK_CALL;
    link_write_all(&mark, 4);
    link_write_all(&call, sizeof call);
    link_write_all(&count, 4);
    link_write_all(bytes, count);
    return link_read();
}

#endif
