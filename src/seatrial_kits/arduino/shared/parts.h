/* Parts at a board's buses and pins. What they are is in Python (`part.py`), in the process that steps the
 * board: here are the registers and replies that it has sent, so that most accesses need no call.
 */
#ifndef SEATRIAL_PARTS_H
#define SEATRIAL_PARTS_H

#include <stdint.h>
#include <string.h>

enum { PART_REGISTERS = 1, PART_STREAM, PART_SPI, PART_PIN };
enum { TABLE_NEXT = 1, TABLE_ACCESS, TABLE_REPLY };
enum { ACCESS_READ_ONLY = 1, ACCESS_WRITE_CALLS = 2, ACCESS_READ_CALLS = 4 };
enum { CALL_BEGIN = 'b', CALL_WRITE = 'w', CALL_READ = 'r', CALL_TRANSFER = 'x', CALL_SELECT = 's', CALL_EDGE = 'e' };
enum { PARTS = 16, PART_BYTES = 1024, PART_BEGINS = 0x100, PART_MASK = 0xFF };

typedef struct {
    uint8_t kind, place, mask, begins; /* begins: addressing it for reading is a call */
    uint8_t pointer, pointed, deaf, selected;
    uint8_t store[256], next[256], access[256];
    uint8_t reply[PART_BYTES], sent[PART_BYTES];
    uint16_t reply_at, reply_length, sent_length;
    uint8_t beyond; /* the reply of a part that has none left */
} part;

static part parts[PARTS];
static int part_count;
static part *part_open;

/* The call into the process that steps the board; its answer has changed the part when it returns. */
static uint64_t part_call(uint8_t call, part *one, uint16_t value);

/* A part: IN_PART's `value` is its kind, and `number` its mask of pointers, with PART_BEGINS. */
static void part_add(const link_input *input)
{
    if (part_count == PARTS)
        return;
    part *one = &parts[part_count++];
    memset(one, 0, sizeof *one);
    one->kind = (uint8_t)input->value;
    one->place = input->index;
    one->mask = (uint8_t)((int)input->number & PART_MASK);
    one->begins = ((int)input->number & PART_BEGINS) != 0;
    one->beyond = one->kind == PART_SPI ? 0xFF : 0;
    for (int each = 0; each < 256; each++)
        one->next[each] = (uint8_t)(each + 1);
}

/* IN_REGISTER: of part `index`, entry of table `number` at the high byte of `value` is its low one; of
 * replies, it comes behind those there are. */
static void part_set(const link_input *input)
{
    part *one = &parts[input->index % PARTS];
    uint8_t at = (uint8_t)(input->value >> 8), data = (uint8_t)input->value;
    switch ((int)input->number) {
    case TABLE_NEXT: one->next[at] = data; break;
    case TABLE_ACCESS: one->access[at] = data; break;
    case TABLE_REPLY:
        if (one->reply_length < PART_BYTES)
            one->reply[one->reply_length++] = data;
        break;
    }
}

/* IN_REGISTERS: of part `index`, as many registers as the low byte of `value` says, from its high one on: the
 * bytes of `number`. */
static void part_store(const link_input *input)
{
    memcpy(parts[input->index % PARTS].store + (input->value >> 8), &input->number, input->value & 0xFF);
}

/* IN_REPLY: the replies of part `index` are dropped; whether it is `deaf`, and the byte `beyond` its replies. */
static void part_clear(const link_input *input)
{
    part *one = &parts[input->index % PARTS];
    one->reply_at = one->reply_length = 0;
    one->deaf = (uint8_t)(input->value >> 8);
    one->beyond = (uint8_t)input->value;
}

/* ------------------------------------------------------------------ I2C */

/* Address a part; returns whether one answers. */
static int part_begin(uint8_t address, int reading)
{
    part_open = 0;
    for (int each = 0; each < part_count; each++)
        if (parts[each].kind <= PART_STREAM && parts[each].place == address && !parts[each].deaf)
            part_open = &parts[each];
    if (!part_open)
        return 0;
    part_open->pointed = 0;
    if (part_open->begins && reading)
        part_call(CALL_BEGIN, part_open, (uint16_t)(part_open->reply_length - part_open->reply_at));
    return 1;
}

static int part_write(uint8_t data)
{
    part *one = part_open;
    if (!one)
        return 0;
    if (one->kind == PART_STREAM)
        return (int)part_call(CALL_WRITE, one, data);
    if (!one->pointed) {
        one->pointer = data;
        one->pointed = 1;
        return 1;
    }
    uint8_t at = one->pointer & one->mask;
    one->pointer = one->next[one->pointer];
    if (one->access[at] & ACCESS_READ_ONLY)
        return 1;
    one->store[at] = data;
    if (one->access[at] & ACCESS_WRITE_CALLS)
        return (int)part_call(CALL_WRITE, one, (uint16_t)(at << 8 | data));
    return 1;
}

static uint8_t part_reply(part *one)
{
    return one->reply_at < one->reply_length ? one->reply[one->reply_at++] : one->beyond;
}

static uint8_t part_read(void)
{
    part *one = part_open;
    if (!one)
        return 0xFF;
    if (one->kind == PART_STREAM)
        return part_reply(one);
    uint8_t at = one->pointer & one->mask;
    if (one->access[at] & ACCESS_READ_CALLS)
        part_call(CALL_READ, one, at);
    one->pointer = one->next[one->pointer];
    return one->store[at];
}

/* ------------------------------------------------------------------ SPI */

/* The select pin of a part has another level: low is selected. What was sent since its last call comes along. */
static void part_select(part *one, int selected)
{
    if (one->selected == selected)
        return;
    one->selected = (uint8_t)selected;
    part_call(CALL_SELECT, one, (uint16_t)selected);
}

/* A byte goes out while another comes in: the reply was there before. */
static uint8_t part_transfer(uint8_t data)
{
    uint8_t all = 0xFF;
    for (int each = 0; each < part_count; each++) {
        part *one = &parts[each];
        if (one->kind != PART_SPI || !one->selected)
            continue;
        if (one->reply_at == one->reply_length || one->sent_length == PART_BYTES)
            part_call(CALL_TRANSFER, one, 0);
        all &= part_reply(one);
        if (one->sent_length < PART_BYTES)
            one->sent[one->sent_length++] = data;
    }
    return all;
}

/* ------------------------------------------------------------------ pins */

/* A pin has another level by the sketch's doing. */
static void part_edge(uint8_t pin, int level)
{
    for (int each = 0; each < part_count; each++) {
        part *one = &parts[each];
        if (one->kind == PART_SPI && one->place == pin)
            part_select(one, !level);
        else if (one->kind == PART_PIN && one->place == pin)
            part_call(CALL_EDGE, one, (uint16_t)level);
    }
}

static int part_is_at(uint8_t pin)
{
    for (int each = 0; each < part_count; each++)
        if (parts[each].kind >= PART_SPI && parts[each].place == pin)
            return 1;
    return 0;
}

#endif
